#pragma once
// An XML document of an untrusted file, parsed by pugixml. Entities other than the five of XML and
// character references are not replaced, so no file is opened and nothing is expanded.

#include <cstddef>
#include <pugixml.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tactree::builder {

/// A document is malformed. what() is "byte 120: cause".
class XmlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A document exceeds a limit. what() is the cause.
class XmlTooLarge : public XmlError {
 public:
  using XmlError::XmlError;
};

/// Limits of a document. An element takes about 70 bytes of memory, an attribute 40.
struct XmlLimits {
  std::size_t bytes = 0;  ///< of the text
  std::size_t tags = 0;
  unsigned depth = 64;  ///< nesting of elements
};

class XmlDocument {
 public:
  /// Throws XmlError.
  XmlDocument(std::string text, const XmlLimits& limits);
  // Not copyable, because the nodes point into the object.
  XmlDocument(const XmlDocument&) = delete;
  XmlDocument& operator=(const XmlDocument&) = delete;

  /// The parent of the outermost element.
  [[nodiscard]] pugi::xml_node root() const { return document_.root(); }

 private:
  std::string text_;  // parsed in place
  pugi::xml_document document_;
};

/// Name without its prefix: "model" for <m:model>.
[[nodiscard]] std::string_view local_name(pugi::xml_node element);

/// The first child element with this local name, or a null node if there is none.
[[nodiscard]] pugi::xml_node child_of(pugi::xml_node parent, std::string_view name);

/// The next node of the subtree of `root`, in the order of the document, or a null node.
[[nodiscard]] pugi::xml_node next_node(pugi::xml_node at, pugi::xml_node root);

/// Value of an attribute, by its local name; empty if there is none.
[[nodiscard]] std::string_view attribute_of(pugi::xml_node element, std::string_view name);

/// Calls visit(element) for the child elements with this local name.
template <typename Visit>
void for_children(pugi::xml_node parent, std::string_view name, Visit&& visit) {
  for (const pugi::xml_node child : parent.children()) {
    if (child.type() == pugi::node_element && local_name(child) == name) {
      visit(child);
    }
  }
}

}  // namespace tactree::builder
