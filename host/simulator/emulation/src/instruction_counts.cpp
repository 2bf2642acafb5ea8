#include "tactree/emulation/instruction_counts.hpp"

#include <cxxabi.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "tactree/emulation/emulation_error.hpp"

namespace tactree::emulation {
namespace {

std::string demangle(const std::string& name) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> words(
      abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status), &std::free);
  return status == 0 ? words.get() : name;
}

}  // namespace

InstructionCounts parse_instruction_counts(const std::string& report) {
  InstructionCounts counts;
  std::istringstream lines(report);
  bool complete = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "function") {
      FunctionCount function;
      words >> function.max >> function.total >> function.name;
      function.name = demangle(function.name);
      counts.functions.push_back(function);
    } else if (key == "ticks") {
      words >> counts.ticks >> counts.max >> counts.total >> counts.checksum >> counts.start;
    } else if (key == "bucket") {
      InstructionBucket bucket;
      words >> bucket.fewest >> bucket.ticks;
      counts.buckets.push_back(bucket);
    } else if (key == "worst") {
      words >> counts.worst_tick;
    } else if (key == "code") {
      CodeRange range;
      words >> std::hex >> range.begin >> range.end;
      counts.code.push_back(range);
    } else if (key == "data") {
      DataRange range;
      words >> std::hex >> range.instruction >> range.lowest >> range.highest;
      counts.data.push_back(range);
    } else if (key == "end") {
      complete = true;
    }
    if (words.fail()) {
      break;
    }
  }
  if (!complete) {
    throw EmulationError("emulation: the instruction counter's report is not complete");
  }
  std::ranges::stable_sort(counts.functions, [](const FunctionCount& a, const FunctionCount& b) {
    return a.total > b.total;
  });
  return counts;
}

}  // namespace tactree::emulation
