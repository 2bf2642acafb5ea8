#include "mesh_import/xml_document.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace tactree::builder {
namespace {

std::string_view without_prefix(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

// Iterative, because a malicious nesting depth would exhaust the stack of a recursion.
void check_depth(pugi::xml_node root, unsigned limit) {
  unsigned depth = 0;
  for (pugi::xml_node at = root; !at.empty();) {
    pugi::xml_node next = at.first_child();
    depth += next.empty() ? 0U : 1U;
    if (depth > limit) {
      throw XmlTooLarge("byte " + std::to_string(next.offset_debug()) +
                        ": elements are nested more than " + std::to_string(limit) + " deep");
    }
    while (next.empty() && !(at == root)) {
      next = at.next_sibling();
      if (next.empty()) {
        at = at.parent();
        --depth;
      }
    }
    at = next;
  }
}

}  // namespace

XmlDocument::XmlDocument(std::string text, const XmlLimits& limits) : text_(std::move(text)) {
  if (text_.size() > limits.bytes) {
    throw XmlTooLarge("its " + std::to_string(text_.size()) + " bytes are more than the " +
                      std::to_string(limits.bytes) + " that are read");
  }
  const auto tags = std::count(text_.begin(), text_.end(), '<');
  if (static_cast<std::size_t>(tags) > limits.tags) {
    throw XmlTooLarge("its " + std::to_string(tags) + " tags are more than the " +
                      std::to_string(limits.tags) + " that are read");
  }
  const pugi::xml_parse_result result = document_.load_buffer_inplace(text_.data(), text_.size());
  if (result.status == pugi::status_out_of_memory) {
    throw XmlTooLarge("its " + std::to_string(tags) + " tags need more memory than is allowed");
  }
  if (!result) {
    std::string cause = result.description();
    cause[0] = static_cast<char>(cause[0] | 0x20);  // lower case, because it continues a sentence
    throw XmlError("byte " + std::to_string(result.offset) + ": " + cause);
  }
  check_depth(document_.root(), limits.depth);
}

std::string_view local_name(pugi::xml_node element) { return without_prefix(element.name()); }

pugi::xml_node child_of(pugi::xml_node parent, std::string_view name) {
  return parent.find_child([&](pugi::xml_node child) {
    return child.type() == pugi::node_element && local_name(child) == name;
  });
}

pugi::xml_node next_node(pugi::xml_node at, pugi::xml_node root) {
  if (const pugi::xml_node child = at.first_child(); !child.empty()) return child;
  while (at != root && at.next_sibling().empty()) at = at.parent();
  return at == root ? pugi::xml_node{} : at.next_sibling();
}

std::string_view attribute_of(pugi::xml_node element, std::string_view name) {
  return element
      .find_attribute([&](pugi::xml_attribute a) { return without_prefix(a.name()) == name; })
      .value();
}

}  // namespace tactree::builder
