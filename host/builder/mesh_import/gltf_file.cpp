#include "mesh_import/gltf_file.hpp"

#include <algorithm>
#include <array>
#include <assimp/IOStream.hpp>
#include <cstring>
#include <limits>

#include "mesh_import/meshopt_view.hpp"
#include "tactree/support/uri.hpp"

namespace tactree::builder {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxCount = std::size_t{1} << 40;
constexpr std::size_t kMaxZeros = std::size_t{1} << 26;  // elements of an accessor without bytes
constexpr std::size_t kGlbHeader = 12;
constexpr std::size_t kChunkHeader = 8;

enum ComponentType : std::size_t { kByte = 5120, kUByte, kShort, kUShort, kUInt = 5125, kFloat };

std::string named(const char* kind, std::size_t number) {
  return std::string(kind) + " " + std::to_string(number);
}

std::string read_all(ContainedFiles& files, const std::string& name) {
  Assimp::IOStream* stream = files.Open(name.c_str(), "rb");
  if (stream == nullptr) {
    throw ImportError("its file \"" + name + "\" is missing, or not in the folder of the model");
  }
  std::string bytes(stream->FileSize(), '\0');
  const std::size_t read = bytes.empty() ? 0 : stream->Read(bytes.data(), 1, bytes.size());
  files.Close(stream);
  bytes.resize(read);
  return bytes;
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + sizeof value <= bytes.size()) {
    std::memcpy(&value, bytes.data() + at, sizeof value);
  }
  return value;
}

std::string from_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) {
    text.remove_suffix(1);
  }
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) {
      throw ImportError("a buffer in its text is not valid base64");
    }
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(bits >> static_cast<unsigned>(count) & 0xffU));
    }
  }
  return bytes;
}

std::size_t size_of_component(std::size_t component, const std::string& who) {
  switch (component) {
    case kByte:
    case kUByte:
      return 1;
    case kShort:
    case kUShort:
      return 2;
    case kUInt:
    case kFloat:
      return 4;
    default:
      throw ImportError(who + " has the unknown component type " + std::to_string(component));
  }
}

template <typename Stored>
double load(const unsigned char* at, bool normalized) {
  Stored value{};
  std::memcpy(&value, at, sizeof value);
  const auto number = static_cast<double>(value);
  if constexpr (std::is_integral_v<Stored>) {
    constexpr auto kOne = static_cast<double>(std::numeric_limits<Stored>::max());
    return normalized ? std::max(number / kOne, -1.0) : number;
  }
  return number;
}

double load(const unsigned char* at, std::size_t component, bool normalized) {
  switch (component) {
    case kByte:
      return load<std::int8_t>(at, normalized);
    case kUByte:
      return load<std::uint8_t>(at, normalized);
    case kShort:
      return load<std::int16_t>(at, normalized);
    case kUShort:
      return load<std::uint16_t>(at, normalized);
    case kUInt:
      return load<std::uint32_t>(at, normalized);
    default:
      return load<float>(at, normalized);
  }
}

std::size_t width_of_type(const std::string& type, const std::string& who) {
  struct Type {
    std::string_view name;
    std::size_t width;
  };
  constexpr std::array<Type, 5> kTypes = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}};
  for (const Type& known : kTypes) {
    if (known.name == type) {
      return known.width;
    }
  }
  throw ImportError(who + " has the unknown type \"" + type.substr(0, 20) + "\"");
}

/// Converts a number to the element type of a vector. An index that does not fit becomes the
/// maximum, so that its triangle is dropped.
template <typename Number>
Number converted(double value) {
  if constexpr (std::is_integral_v<Number>) {
    const bool fits = value >= 0.0 && value < 4294967295.0;
    return fits ? static_cast<Number>(value) : std::numeric_limits<Number>::max();
  } else {
    return value;
  }
}

}  // namespace

std::size_t gltf_count(const json& object, const char* name, std::size_t missing) {
  const auto found = object.find(name);
  if (found == object.end()) {
    return missing;
  }
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > kMaxCount) {
    throw ImportError(std::string("its \"") + name + "\" is not a valid number");
  }
  return found->get<std::size_t>();
}

GltfFile::GltfFile(const std::string& file, ContainedFiles& files)
    : files_(files), bytes_(read_all(files, file)) {
  std::string_view text = bytes_;
  if (text.starts_with("\xef\xbb\xbf")) {
    text.remove_prefix(3);
  }
  if (text.starts_with("glTF")) {
    version_ = word_at(text, 4) < 2 ? 1 : 2;
    const std::size_t total = word_at(text, 8);
    if (version_ == 2 && total > text.size()) {
      throw ImportError("it was cut off: its header states " + std::to_string(total) +
                        " bytes, and it holds " + std::to_string(text.size()));
    }
    if (version_ == 1) {
      return;
    }
    undeclared_bytes_ = text.size() - total;
    const std::size_t length = std::min<std::size_t>(word_at(text, kGlbHeader), text.size());
    const std::string_view rest = text.substr(std::min(text.size(), kGlbHeader + kChunkHeader));
    read_binary(rest.substr(std::min(length, rest.size())));
    text = rest.substr(0, length);
  }
  root_ = json::parse(text, nullptr, false);
  if (!root_.is_object()) {
    throw ImportError("its JSON is damaged, or was cut off");
  }
  const json asset = root_.value("asset", json::object());
  if (!asset.is_object()) {
    throw ImportError(kNoStructure);
  }
  const json version = asset.value("version", json("2.0"));
  if (version.is_string() && version.get<std::string>().starts_with("1")) {
    version_ = 1;
  }
  buffers_.resize(root_.value("buffers", json::array()).size());
  is_read_.resize(buffers_.size());
}

void GltfFile::read_binary(std::string_view chunks) {
  if (chunks.size() > kChunkHeader && chunks.substr(4, 3) == "BIN") {
    chunk_ = chunks.substr(kChunkHeader, word_at(chunks, 0));
  }
}

const json& GltfFile::at(const char* list, std::size_t number) const {
  const auto found = root_.find(list);
  if (found == root_.end() || !found->is_array() || number >= found->size() ||
      !(*found)[number].is_object()) {
    throw ImportError("it refers to entry " + std::to_string(number) + " of \"" + list +
                      "\", which it does not have");
  }
  return (*found)[number];
}

std::string GltfFile::read_buffer(std::size_t number) const {
  const json& described = at("buffers", number);
  const auto uri = described.value("uri", std::string());
  if (!uri.starts_with("data:")) {
    return read_all(files_, support::decoded_uri(uri));
  }
  const std::size_t comma = uri.find(";base64,");
  if (comma == std::string::npos) {
    throw ImportError(named("buffer", number) + " is not base64");
  }
  return from_base64(std::string_view(uri).substr(comma + std::strlen(";base64,")));
}

std::string_view GltfFile::buffer(std::size_t number) {
  if (!at("buffers", number).contains("uri")) {
    return number == 0 ? chunk_ : std::string_view{};
  }
  if (!is_read_[number]) {
    buffers_[number] = read_buffer(number);
  }
  is_read_[number] = true;
  return buffers_[number];
}

std::span<const unsigned char> GltfFile::stored(const json& names, const std::string& who) {
  const std::string_view bytes = buffer(gltf_count(names, "buffer", kNoIndex));
  const std::size_t offset = gltf_count(names, "byteOffset");
  const std::size_t length = gltf_count(names, "byteLength");
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw ImportError(who + " ends after the " + std::to_string(bytes.size()) +
                      " bytes of its buffer");
  }
  return {reinterpret_cast<const unsigned char*>(bytes.data()) + offset, length};
}

std::span<const unsigned char> GltfFile::view(std::size_t number, const std::string& who) {
  const json& names = at("bufferViews", number);
  const json* const compressed = meshopt_of(names);
  if (compressed == nullptr) {
    return stored(names, who);
  }
  auto found = decoded_.find(number);
  if (found == decoded_.end()) {
    const std::span<const unsigned char> packed = stored(*compressed, who);
    found = decoded_.emplace(number, decoded_meshopt(names, packed, who)).first;
  }
  return found->second;
}

GltfFile::Elements GltfFile::elements(const json& names, std::size_t count, std::size_t component,
                                      std::size_t width, const std::string& who) {
  Elements found;
  found.count = count;
  found.component = component;
  const std::size_t size = width * size_of_component(component, who);
  const std::size_t number = gltf_count(names, "bufferView", kNoIndex);
  found.bytes = view(number, who);
  found.stride = gltf_count(at("bufferViews", number), "byteStride", size);
  const std::size_t offset = gltf_count(names, "byteOffset");
  // Counts are at most 2^40, so no product overflows.
  if (found.stride < size || found.stride > 4096) {
    throw ImportError(who + " has an invalid byteStride");
  }
  if (count > 0 && (count - 1) * found.stride + size + offset > found.bytes.size()) {
    throw ImportError(who + " ends after the bytes of its buffer view");
  }
  found.bytes = found.bytes.subspan(std::min(offset, found.bytes.size()));
  return found;
}

std::size_t GltfFile::width(std::size_t accessor) const {
  const std::string who = named("accessor", accessor);
  return width_of_type(at("accessors", accessor).value("type", std::string()), who);
}

template <typename Number>
void GltfFile::read(std::size_t accessor, std::size_t width, std::vector<Number>& into) {
  const std::string who = named("accessor", accessor);
  const json& described = at("accessors", accessor);
  if (this->width(accessor) != width) {
    throw ImportError(who + " has a type that does not fit its use");
  }
  const std::size_t count = gltf_count(described, "count");
  const std::size_t component = gltf_count(described, "componentType");
  const bool normalized = described.value("normalized", false) && component != kFloat;
  const std::size_t step = size_of_component(component, who);
  const auto put = [&](const Elements& from, std::size_t element, std::size_t to) {
    for (std::size_t k = 0; k < width; ++k) {
      const unsigned char* at = from.bytes.data() + element * from.stride + k * step;
      into[to * width + k] = converted<Number>(load(at, component, normalized));
    }
  };
  if (described.contains("bufferView")) {
    const Elements from = elements(described, count, component, width, who);
    into.resize(count * width);
    for (std::size_t i = 0; i < count; ++i) {
      put(from, i, i);
    }
  } else if (count <= kMaxZeros) {
    into.assign(count * width, Number{});
  } else {
    throw ImportError(who + " states " + std::to_string(count) + " elements and has no bytes");
  }
  const auto sparse = described.find("sparse");
  if (sparse == described.end()) {
    return;
  }
  const std::size_t changed = gltf_count(*sparse, "count");
  const json where = sparse->value("indices", json::object());
  const std::size_t index_type = gltf_count(where, "componentType");
  const Elements indices = elements(where, changed, index_type, 1, who);
  const Elements values =
      elements(sparse->value("values", json::object()), changed, component, width, who);
  for (std::size_t i = 0; i < changed; ++i) {
    const double to = load(indices.bytes.data() + i * indices.stride, index_type, false);
    if (!(to >= 0.0 && to < static_cast<double>(count))) {
      throw ImportError(who + " changes an element that it does not have");
    }
    put(values, i, static_cast<std::size_t>(to));
  }
}

std::vector<double> GltfFile::numbers(std::size_t accessor, std::size_t width) {
  std::vector<double> numbers;
  read(accessor, width, numbers);
  return numbers;
}

std::vector<std::uint32_t> GltfFile::indices(std::size_t accessor) {
  std::vector<std::uint32_t> indices;
  read(accessor, 1, indices);
  return indices;
}

}  // namespace tactree::builder
