#include "mesh_import/xml_tags.hpp"

#include <algorithm>
#include <array>

namespace tactree::builder {
namespace {

constexpr std::string_view kXmlSpaces = " \t\r\n";

std::string_view without_prefix(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

/// The end of the tag that begins before `at`: the first '>' outside quotes.
std::size_t end_of_tag(std::string_view text, std::size_t at) {
  char quote = '\0';
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at;
    }
  }
  return std::string_view::npos;
}

}  // namespace

bool XmlTags::skip_after(std::string_view ending) {
  const std::size_t end = text_.find(ending, at_);
  cut_off_ = end == std::string_view::npos;
  at_ = cut_off_ ? text_.size() : end + ending.size();
  return !cut_off_;
}

bool XmlTags::next() {
  while (true) {
    const std::size_t after = at_;
    at_ = text_.find('<', at_);
    before_ = text_.substr(after, at_ - after);
    if (at_ == std::string_view::npos) {
      at_ = text_.size();
      return false;
    }
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("<!--")) {
      if (!skip_after("-->")) return false;
    } else if (rest.starts_with("<![CDATA[")) {
      if (!skip_after("]]>")) return false;
    } else if (rest.starts_with("<?")) {
      if (!skip_after("?>")) return false;
    } else if (rest.starts_with("<!")) {
      if (!skip_after(">")) return false;
    } else {
      break;
    }
  }
  begin_ = at_;
  const std::size_t end = end_of_tag(text_, at_ + 1);
  if (end == std::string_view::npos) {
    cut_off_ = true;
    at_ = text_.size();
    return false;
  }
  std::string_view tag = text_.substr(at_ + 1, end - at_ - 1);
  at_ = end + 1;
  closes_ = tag.starts_with('/');
  if (closes_) tag.remove_prefix(1);
  is_empty_ = tag.ends_with('/');
  if (is_empty_) tag.remove_suffix(1);
  const std::size_t name_end = std::min(tag.find_first_of(kXmlSpaces), tag.size());
  name_ = without_prefix(tag.substr(0, name_end));
  read_attributes(tag.substr(name_end));
  return true;
}

void XmlTags::read_attributes(std::string_view tag) {
  attributes_.clear();
  while (true) {
    const std::size_t begin = tag.find_first_not_of(kXmlSpaces);
    if (begin == std::string_view::npos) return;
    tag.remove_prefix(begin);
    const std::size_t equals = tag.find('=');
    if (equals == std::string_view::npos) return;
    std::string_view name = tag.substr(0, equals);
    name = name.substr(0, name.find_first_of(kXmlSpaces));
    const std::size_t quote = tag.find_first_not_of(kXmlSpaces, equals + 1);
    if (quote == std::string_view::npos || (tag[quote] != '"' && tag[quote] != '\'')) return;
    const std::size_t end = tag.find(tag[quote], quote + 1);
    if (end == std::string_view::npos) return;
    attributes_.emplace_back(name, tag.substr(quote + 1, end - quote - 1));
    tag.remove_prefix(end + 1);
  }
}

std::string_view XmlTags::attribute(std::string_view name) const {
  for (const auto& [full, value] : attributes_) {
    if (without_prefix(full) == name) return value;
  }
  return {};
}

std::string without_entities(std::string_view value) {
  struct Entity {
    std::string_view text;
    char character;
  };
  constexpr std::array<Entity, 5> kEntities = {
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string text;
  while (!value.empty()) {
    std::size_t taken = 1;
    char character = value.front();
    for (const Entity& entity : kEntities) {
      if (value.starts_with(entity.text)) {
        taken = entity.text.size();
        character = entity.character;
      }
    }
    text.push_back(character);
    value.remove_prefix(taken);
  }
  return text;
}

}  // namespace tactree::builder
