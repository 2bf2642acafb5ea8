// Every public header of hal/, each of which must compile by itself, for check-style.
#include "tactree/hal/board.hpp"
#include "tactree/hal/conformance.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/sim/board.hpp"
#include "tactree/hal/sim/delay_line.hpp"
#include "tactree/hal/sim/encoder_bank.hpp"
#include "tactree/hal/sim/motor_bank.hpp"
