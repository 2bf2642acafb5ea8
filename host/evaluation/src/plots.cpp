#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {
std::map<std::string, std::string> plots(const Result&) { return {}; }
}
