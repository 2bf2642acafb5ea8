#include "mesh_import/file_bytes.hpp"

#include <algorithm>
#include <fstream>

namespace tactree::builder {

std::string file_bytes(const std::string& file, std::size_t most) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = std::max<std::streamoff>(in.tellg(), 0);
  std::string bytes(std::min(static_cast<std::size_t>(size), most), '\0');
  in.seekg(0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

}  // namespace tactree::builder
