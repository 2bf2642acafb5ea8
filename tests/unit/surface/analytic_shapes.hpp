#pragma once
// The surfaces of `tactree evaluate`, under the tests' name.

#include "tactree/evaluation/shapes.hpp"

namespace tactree::test {
using namespace evaluation;  // NOLINT(google-build-using-namespace): one name for both
}  // namespace tactree::test
