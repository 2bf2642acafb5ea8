#include "fault_advice.hpp"

#include <array>
#include <cctype>

#include "tactree/viewer/markdown.hpp"
#include "tactree/viewer/site.hpp"

namespace tactree::viewer {
namespace {

/// The dots of "e.g. this" and of a range "a .. b" end no sentence.
std::string first_sentence(const std::string& text) {
  for (std::size_t i = 0; i + 2 < text.size(); ++i) {
    if (text[i] == '.' && text[i + 1] == ' ' &&
        std::isupper(static_cast<unsigned char>(text[i + 2])) != 0) {
      return text.substr(0, i + 1);
    }
  }
  return text;
}

std::string advice_of_page(std::string_view name) {
  for (const Asset& page : fault_pages()) {
    if (page.path == name) {
      return first_sentence(markdown_paragraph(page.content, "")) + " " +
             first_sentence(markdown_paragraph(page.content, "What to do"));
    }
  }
  return "";
}

}  // namespace

const std::string& fault_advice(core::Fault fault) {
  static const std::array<std::string, core::kFaultCodes> kAdvice = [] {
    std::array<std::string, core::kFaultCodes> advice;
    for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
      advice[code] = advice_of_page(core::name_of(static_cast<core::Fault>(code)));
    }
    return advice;
  }();
  return kAdvice[static_cast<std::uint32_t>(fault)];
}

}  // namespace tactree::viewer
