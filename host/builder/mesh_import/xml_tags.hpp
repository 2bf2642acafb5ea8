#pragma once
// The tags of an XML document, one after the other, with the text before each. Comments, CDATA and
// processing instructions are skipped. No entity but the five of XML is replaced.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactree::builder {

class XmlTags {
 public:
  explicit XmlTags(std::string_view text) : text_(text) {}

  /// Goes to the next tag. False at the end of the text, also inside a tag.
  [[nodiscard]] bool next();
  /// Whether the text ended inside a tag or comment.
  [[nodiscard]] bool cut_off() const { return cut_off_; }

  /// The text between the last tag and this one, without a comment in it.
  [[nodiscard]] std::string_view text_before() const { return before_; }
  /// Offset of the tag.
  [[nodiscard]] std::size_t offset() const { return begin_; }
  /// Name without its prefix: "model" of <m:model>.
  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] bool closes() const { return closes_; }      ///< </name>
  [[nodiscard]] bool is_empty() const { return is_empty_; }  ///< <name/>
  /// Value of an attribute, by its name without prefix; empty if there is none.
  [[nodiscard]] std::string_view attribute(std::string_view name) const;
  /// All attributes with their full names.
  [[nodiscard]] const std::vector<std::pair<std::string_view, std::string_view>>& attributes()
      const {
    return attributes_;
  }

 private:
  [[nodiscard]] bool skip_after(std::string_view ending);
  void read_attributes(std::string_view tag);

  std::string_view text_;
  std::size_t at_ = 0;
  bool cut_off_ = false;
  std::size_t begin_ = 0;
  std::string_view before_;
  std::string_view name_;
  bool closes_ = false;
  bool is_empty_ = false;
  std::vector<std::pair<std::string_view, std::string_view>> attributes_;
};

/// Replaces &amp; &lt; &gt; &quot; &apos;
[[nodiscard]] std::string without_entities(std::string_view value);

}  // namespace tactree::builder
