#include "mesh_import/xml_document.hpp"

#include <gtest/gtest.h>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

constexpr XmlLimits kLimits{4096, 100, 8};

std::string refusal_of(std::string text) {
  return test::message_of<XmlError>([&] { const XmlDocument document(std::move(text), kLimits); });
}

std::string nested(unsigned depth) {
  std::string text;
  for (unsigned i = 0; i < depth; ++i) text += "<a>";
  for (unsigned i = 0; i < depth; ++i) text += "</a>";
  return text;
}

TEST(XmlDocument, FindsNodesByLocalName) {
  const XmlDocument document(
      "\xEF\xBB\xBF<?xml version='1.0'?><!DOCTYPE a [<!ENTITY e 'x'>]>\r\n<!-- <m:model/> -->"
      "<m:model xmlns:m='urn:m' p:path='a&amp;b&#x41;'>\n<x/>text<![CDATA[<5>]]><m:x k=\"2\"/>"
      "</m:model>",
      kLimits);
  const pugi::xml_node model = child_of(document.root(), "model");
  EXPECT_EQ(local_name(model), "model");
  EXPECT_EQ(attribute_of(model, "path"), "a&bA");
  EXPECT_EQ(attribute_of(model, "none"), "");
  EXPECT_TRUE(child_of(model, "y").empty());
  EXPECT_EQ(attribute_of(child_of(child_of(document.root(), "none"), "x"), "k"), "");
  std::string values;
  for_children(model, "x",
               [&](pugi::xml_node x) { values += attribute_of(x, "k").empty() ? "-" : "2"; });
  EXPECT_EQ(values, "-2");
}

TEST(XmlDocument, ReadsUtf16) {
  std::string text("\xFF\xFE", 2);
  for (const char c : std::string("<a k='1'/>")) text += {c, '\0'};
  const XmlDocument document(text, kLimits);
  EXPECT_EQ(attribute_of(child_of(document.root(), "a"), "k"), "1");
}

TEST(XmlDocument, LocatesMalformedText) {
  EXPECT_EQ(refusal_of("<a><b></a>").find("byte 8: start-end tags mismatch"), 0U)
      << refusal_of("<a><b></a>");
  for (const char* const text :
       {"", "   ", "text", "<a", "<a>", "<a k>", "<a k=1/>", "<a k='1/>", "<a><!-- </a>",
        "<a><![CDATA[ </a>", "<1/>", "</a>", "<a></b>", "<?xml"}) {
    EXPECT_EQ(refusal_of(text).find("byte "), 0U) << text << ": " << refusal_of(text);
  }
}

TEST(XmlDocument, LimitsSizeTagsAndDepth) {
  EXPECT_EQ(refusal_of("<a/>" + std::string(4092, ' ')), "");
  EXPECT_EQ(refusal_of("<a/>" + std::string(4093, ' ')),
            "its 4097 bytes are more than the 4096 that are read");
  std::string many = "<a>";
  for (int i = 0; i < 98; ++i) many += "<b/>";
  EXPECT_EQ(refusal_of(many + "</a>"), "");
  EXPECT_EQ(refusal_of(many + "<b/></a>"), "its 101 tags are more than the 100 that are read");
  EXPECT_EQ(refusal_of(nested(8)), "");
  EXPECT_EQ(refusal_of("<r><a/><a><a/></a></r>"), "");
  EXPECT_EQ(refusal_of(nested(9)), "byte 25: elements are nested more than 8 deep");
  std::string side_by_side = "<a>";
  for (int i = 0; i < 20; ++i) side_by_side += "<b><c/></b>";
  EXPECT_EQ(refusal_of(side_by_side + "</a>"), "");
}

class XmlFiles : public TestFiles {};

/// An entity of the document is neither expanded nor fetched.
TEST_F(XmlFiles, KeepsEntitiesAsText) {
  const std::filesystem::path secret = write("secret", "secret.txt");
  const XmlDocument document("<!DOCTYPE a [<!ENTITY f SYSTEM \"file://" + secret.string() +
                                 "\"><!ENTITY l \"&l;&l;\">]><a k='&f;&l;'>&f;</a>",
                             kLimits);
  const pugi::xml_node a = child_of(document.root(), "a");
  EXPECT_EQ(attribute_of(a, "k"), "&f;&l;");
  EXPECT_EQ(std::string(a.child_value()), "&f;");
}

/// A depth that would exhaust the stack of a reader that recurses.
TEST(XmlDocument, RefusesMillionNestedElements) {
  try {
    const XmlDocument document(nested(1'000'000), {std::size_t{1} << 26, 10'000'000, 64});
    FAIL();
  } catch (const XmlError& error) {
    EXPECT_NE(std::string(error.what()).find("more than 64 deep"), std::string::npos);
  }
}

}  // namespace
}  // namespace tactree::builder
