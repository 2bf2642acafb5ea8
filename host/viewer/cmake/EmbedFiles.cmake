# tactree_embed_files(<function> <source> <path> <type> <file>...)
# Writes a C++ source that holds the files and a function of namespace tactree::viewer that lists
# them as Assets. The assembler copies the bytes, so a megabyte takes no time to compile.
function(tactree_embed_files function source)
  set(blocks "")
  set(rows "")
  set(files "")
  set(number 0)
  set(arguments ${ARGN})
  while(arguments)
    list(POP_FRONT arguments path type file)
    list(APPEND files ${file})
    set(symbol tactree_${function}_${number})
    string(APPEND blocks
      "asm(\".pushsection .rodata\\n\"\n"
      "    \"${symbol}_begin: .incbin \\\"${file}\\\"\\n\"\n"
      "    \"${symbol}_end: .byte 0\\n\"\n"
      "    \".popsection\");\n"
      "extern \"C\" const char ${symbol}_begin[] asm(\"${symbol}_begin\");\n"
      "extern \"C\" const char ${symbol}_end[] asm(\"${symbol}_end\");\n")
    string(APPEND rows
      "      Asset{\"${path}\", \"${type}\", between(${symbol}_begin, ${symbol}_end)},\n")
    math(EXPR number "${number} + 1")
  endwhile()
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${source} @ONLY NEWLINE_STYLE UNIX CONTENT
"// Written by host/viewer/cmake/EmbedFiles.cmake.
#include \"tactree/viewer/site.hpp\"

@blocks@
namespace tactree::viewer {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::span<const Asset> @function@() {
  static const Asset files[] = {
@rows@  };
  return files;
}

}  // namespace tactree::viewer
")
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/${source} PROPERTIES
    OBJECT_DEPENDS "${files}" SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
