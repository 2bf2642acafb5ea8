#include <fmt/format.h>

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {
std::string to_markdown(const Result&, const std::string&) { return ""; }
std::string target_lines(const Result& result) {
  std::string text;
  for (const Target& t : result.targets) text += fmt::format("{} {} {} .. {}  {:.6g}\n", t.met() ? "met" : "MISSED", t.name, t.low, t.high, t.value);
  return text;
}
}
