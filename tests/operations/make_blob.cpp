// Writes the blob that operations_test touches: the cosine sheet at h = 1 mm.

#include <cstdio>
#include <fstream>

#include "tactree/evaluation/shapes.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_blob FILE\n", stderr);
    return 2;
  }
  const tactree::evaluation::Shape shape = tactree::evaluation::cos_sheet();
  std::ofstream file(argv[1], std::ios::binary);
  file.write(reinterpret_cast<const char*>(shape.bytes().data()),
             static_cast<std::streamsize>(shape.bytes().size()));
  return file.good() ? 0 : 1;
}
