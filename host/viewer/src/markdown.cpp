#include "tactree/viewer/markdown.hpp"

#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>
#include <fmt/format.h>

#include <memory>
#include <vector>

namespace tactree::viewer {
namespace {

constexpr const char* kPage = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{}</title><style>
:root {{ color-scheme: light dark; }}
body {{ font: 16px/1.6 system-ui, sans-serif; max-width: 60rem; margin: 3rem auto; padding: 0 1rem; }}
h1 {{ font-size: 1.5rem; }} h2 {{ font-size: 1.15rem; margin-top: 2.5rem; }}
code {{ font-size: 0.95em; }} svg {{ max-width: 100%; height: auto; }}
table {{ border-collapse: collapse; display: block; overflow-x: auto; }}
th, td {{ padding: 0.15rem 1rem 0.15rem 0; border-bottom: 1px solid #8884; text-align: left; }}
</style></head><body>
{}</body></html>
)";

struct FreeNode {
  void operator()(cmark_node* node) const { cmark_node_free(node); }
};
using Document = std::unique_ptr<cmark_node, FreeNode>;

struct FreeParser {
  void operator()(cmark_parser* parser) const { cmark_parser_free(parser); }
};
using Parser = std::unique_ptr<cmark_parser, FreeParser>;

struct FreeText {
  void operator()(char* text) const { cmark_get_default_mem_allocator()->free(text); }
};

Document parse(std::string_view markdown, const Parser& parser) {
  cmark_gfm_core_extensions_ensure_registered();
  cmark_parser_attach_syntax_extension(parser.get(), cmark_find_syntax_extension("table"));
  cmark_parser_feed(parser.get(), markdown.data(), markdown.size());
  return Document(cmark_parser_finish(parser.get()));
}

/// Without CMARK_OPT_UNSAFE the renderer drops raw HTML and script addresses.
std::string render(cmark_node* node, cmark_llist* extensions) {
  const std::unique_ptr<char, FreeText> html(
      cmark_render_html(node, CMARK_OPT_DEFAULT, extensions));
  return html.get();
}

cmark_node* text_node(const std::string& text) {
  cmark_node* const node = cmark_node_new(CMARK_NODE_TEXT);
  cmark_node_set_literal(node, text.c_str());
  return node;
}

void replace(cmark_node* old, cmark_node* by) {
  cmark_node_replace(old, by);
  cmark_node_free(old);
}

void replace_by_children(cmark_node* node) {
  while (cmark_node* const child = cmark_node_first_child(node)) {
    cmark_node_insert_before(node, child);
  }
  cmark_node_free(node);
}

/// Raw HTML becomes text, so that a reader sees what the renderer would drop.
void show_as_text(cmark_node* node) {
  cmark_node* text = text_node(cmark_node_get_literal(node));
  if (cmark_node_get_type(node) == CMARK_NODE_HTML_BLOCK) {
    cmark_node* const paragraph = cmark_node_new(CMARK_NODE_PARAGRAPH);
    cmark_node_append_child(paragraph, text);
    text = paragraph;
  }
  replace(node, text);
}

void resolve_link(cmark_node* node, const MarkdownTargets& targets) {
  const std::string address = targets.link ? targets.link(cmark_node_get_url(node)) : "";
  if (address.empty()) {
    replace_by_children(node);
  } else {
    cmark_node_set_url(node, address.c_str());
  }
}

void resolve_picture(cmark_node* node, const MarkdownTargets& targets) {
  if (!targets.picture) {
    replace_by_children(node);
    return;
  }
  cmark_node* const markup = cmark_node_new(CMARK_NODE_CUSTOM_INLINE);
  cmark_node_set_on_enter(markup, targets.picture(cmark_node_get_url(node)).c_str());
  replace(node, markup);
}

/// All nodes, parents before their children.
std::vector<cmark_node*> nodes_of(cmark_node* document) {
  std::vector<cmark_node*> nodes;
  cmark_iter* const iterator = cmark_iter_new(document);
  for (cmark_event_type event = cmark_iter_next(iterator); event != CMARK_EVENT_DONE;
       event = cmark_iter_next(iterator)) {
    if (event == CMARK_EVENT_ENTER) {
      nodes.push_back(cmark_iter_get_node(iterator));
    }
  }
  cmark_iter_free(iterator);
  return nodes;
}

void resolve(cmark_node* document, const MarkdownTargets& targets) {
  // Children first, because the replacement of a node frees its children.
  const std::vector<cmark_node*> nodes = nodes_of(document);
  for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
    const cmark_node_type type = cmark_node_get_type(*node);
    if (type == CMARK_NODE_LINK) {
      resolve_link(*node, targets);
    } else if (type == CMARK_NODE_IMAGE) {
      resolve_picture(*node, targets);
    } else if (type == CMARK_NODE_HTML_INLINE || type == CMARK_NODE_HTML_BLOCK) {
      show_as_text(*node);
    }
  }
}

/// The words of a paragraph or heading, on one line.
std::string text_of(cmark_node* node) {
  std::string text;
  for (cmark_node* const part : nodes_of(node)) {
    const cmark_node_type type = cmark_node_get_type(part);
    if (type == CMARK_NODE_TEXT || type == CMARK_NODE_CODE) {
      text += cmark_node_get_literal(part);
    } else if (type == CMARK_NODE_SOFTBREAK || type == CMARK_NODE_LINEBREAK) {
      text += ' ';
    }
  }
  return text;
}

}  // namespace

std::string markdown_html(std::string_view markdown, const MarkdownTargets& targets) {
  const Parser parser(cmark_parser_new(CMARK_OPT_DEFAULT));
  const Document document = parse(markdown, parser);
  resolve(document.get(), targets);
  return render(document.get(), cmark_parser_get_syntax_extensions(parser.get()));
}

std::string markdown_paragraph(std::string_view markdown, std::string_view heading) {
  const Parser parser(cmark_parser_new(CMARK_OPT_DEFAULT));
  const Document document = parse(markdown, parser);
  bool is_below = heading.empty();
  for (cmark_node* node = cmark_node_first_child(document.get()); node != nullptr;
       node = cmark_node_next(node)) {
    if (cmark_node_get_type(node) == CMARK_NODE_PARAGRAPH && is_below) {
      return text_of(node);
    }
    if (cmark_node_get_type(node) == CMARK_NODE_HEADING &&
        cmark_node_get_heading_level(node) == 2) {
      is_below = text_of(node) == heading;
    }
  }
  return "";
}

std::string escaped_html(std::string_view text) {
  const Document document(text_node(std::string(text)));
  return render(document.get(), nullptr);
}

std::string html_page(std::string_view title, std::string_view body) {
  return fmt::format(fmt::runtime(kPage), escaped_html(title), body);
}

}  // namespace tactree::viewer
