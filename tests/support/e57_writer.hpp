#pragma once
// Writes small E57 files for tests.

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bytes_of.hpp"

namespace tactree::test {

/// One number of every point.
struct E57Column {
  std::string name;
  std::string attributes;              ///< of its element in the prototype
  unsigned bits = 64;                  ///< of a number
  std::vector<std::uint64_t> numbers;  ///< as they are packed
};

inline E57Column e57_double(const std::string& name, const std::vector<double>& values) {
  E57Column column{name, "type=\"Float\"", 64, {}};
  for (const double value : values) column.numbers.push_back(std::bit_cast<std::uint64_t>(value));
  return column;
}

inline E57Column e57_single(const std::string& name, const std::vector<float>& values) {
  E57Column column{name, "type=\"Float\" precision=\"single\"", 32, {}};
  for (const float value : values) column.numbers.push_back(std::bit_cast<std::uint32_t>(value));
  return column;
}

/// scaled: further attributes of a ScaledInteger.
inline E57Column e57_integer(const std::string& name, std::int64_t minimum, std::int64_t maximum,
                             const std::vector<std::int64_t>& values,
                             const std::string& scaled = "") {
  E57Column column;
  column.name = name;
  column.attributes = std::string("type=\"") + (scaled.empty() ? "Integer" : "ScaledInteger") +
                      "\" minimum=\"" + std::to_string(minimum) + "\" maximum=\"" +
                      std::to_string(maximum) + "\" " + scaled;
  const auto low = static_cast<std::uint64_t>(minimum);
  column.bits = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(maximum) - low));
  for (const std::int64_t value : values) {
    column.numbers.push_back(static_cast<std::uint64_t>(value) - low);
  }
  return column;
}

struct E57TestScan {
  std::vector<E57Column> columns;
  std::string xml;               ///< further elements, e.g. the pose
  std::size_t packet_bytes = 7;  ///< of each stream in a packet
  std::string count;             ///< declared; default: the true number
};

inline std::string e57_pose(const std::string& quaternion_wxyz,
                            const std::string& translation_xyz) {
  const auto list = [](const std::string& text, std::string_view names) {
    std::string xml;
    std::size_t begin = 0;
    for (const char name : names) {
      const std::size_t end = text.find(' ', begin);
      xml += std::string("<") + name + " type=\"Float\">" + text.substr(begin, end - begin) + "</" +
             name + ">";
      begin = end + 1;
    }
    return xml;
  };
  return "<pose type=\"Structure\"><rotation type=\"Structure\">" + list(quaternion_wxyz, "wxyz") +
         "</rotation><translation type=\"Structure\">" + list(translation_xyz, "xyz") +
         "</translation></pose>";
}

namespace e57 {

inline std::string packed(const E57Column& column) {
  std::string stream;
  std::size_t bit = 0;
  for (const std::uint64_t number : column.numbers) {
    for (unsigned i = 0; i < column.bits; ++i, ++bit) {
      if (bit % 8 == 0) stream += '\0';
      if (((number >> i) & 1U) != 0)
        stream.back() = static_cast<char>(stream.back() | 1 << bit % 8);
    }
  }
  return stream;
}

inline std::uint64_t physical(std::uint64_t logical) {
  return logical / 1020 * 1024 + logical % 1020;
}

inline std::string data_packet(const std::vector<std::string>& parts) {
  std::string lengths;
  std::string content;
  for (const std::string& part : parts) {
    lengths += bytes_of(static_cast<std::uint16_t>(part.size()));
    content += part;
  }
  std::size_t size = 6 + lengths.size() + content.size();
  content.append((4 - size % 4) % 4, '\0');
  size = 6 + lengths.size() + content.size();
  return std::string("\1\0", 2) + bytes_of(static_cast<std::uint16_t>(size - 1)) +
         bytes_of(static_cast<std::uint16_t>(parts.size())) + lengths + content;
}

/// An index packet, an empty one, then the data; begins at the logical offset `begin`.
inline std::string section(const E57TestScan& scan, std::uint64_t begin) {
  std::string packets =
      std::string("\0\0\x0f\0", 4) + std::string(12, '\0') + std::string("\2\0\3\0", 4);
  std::vector<std::string> streams;
  for (const E57Column& column : scan.columns) streams.push_back(packed(column));
  for (bool more = true; more;) {
    std::vector<std::string> parts;
    more = false;
    for (std::string& stream : streams) {
      parts.push_back(stream.substr(0, scan.packet_bytes));
      stream.erase(0, scan.packet_bytes);
      more = more || !stream.empty();
    }
    packets += data_packet(parts);
  }
  return std::string("\1\0\0\0\0\0\0\0", 8) + bytes_of<std::uint64_t>(32 + packets.size()) +
         bytes_of(physical(begin + 32)) + bytes_of(std::uint64_t{0}) + packets;
}

}  // namespace e57

/// The file with the bytes between the checksums: header, sections, XML.
inline std::string e57_pages(std::string logical) {
  logical.append((1020 - logical.size() % 1020) % 1020, ' ');
  std::string file;
  for (std::size_t at = 0; at < logical.size(); at += 1020) {
    std::uint32_t crc = 0xffffffff;
    for (std::size_t i = at; i < at + 1020; ++i) {
      crc ^= static_cast<unsigned char>(logical[i]);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1U) != 0 ? 0x82f63b78U : 0);
    }
    const std::uint32_t stored = __builtin_bswap32(~crc);
    file += logical.substr(at, 1020) + bytes_of(stored);
  }
  return file;
}

/// Corrects the checksums of a file that was changed.
inline std::string e57_resealed(std::string_view file) {
  std::string logical;
  for (std::size_t at = 0; at + 1024 <= file.size(); at += 1024) logical += file.substr(at, 1020);
  return e57_pages(logical);
}

inline std::string e57_xml_of(const E57TestScan& scan, std::uint64_t offset) {
  std::string prototype;
  for (const E57Column& column : scan.columns) {
    prototype += "<" + column.name + " " + column.attributes + "/>";
  }
  const std::string count =
      scan.count.empty() ? std::to_string(scan.columns.at(0).numbers.size()) : scan.count;
  return "<vectorChild type=\"Structure\">" + scan.xml +
         "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(offset) +
         "\" recordCount=\"" + count + "\"><prototype type=\"Structure\">" + prototype +
         "</prototype><codecs type=\"Vector\"/></points></vectorChild>";
}

inline std::string e57_file(const std::vector<E57TestScan>& scans) {
  std::string logical(48, '\0');
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?><e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\"><data3D type=\"Vector\">";
  for (const E57TestScan& scan : scans) {
    xml += e57_xml_of(scan, e57::physical(logical.size()));
    logical += e57::section(scan, logical.size());
  }
  xml += "</data3D></e57Root>";
  const std::uint64_t xml_at = logical.size();
  const std::uint64_t pages = (xml_at + xml.size() + 1019) / 1020;
  const std::string header = "ASTM-E57" + bytes_of(1U) + bytes_of(0U) +
                             bytes_of<std::uint64_t>(1024 * pages) +
                             bytes_of(e57::physical(xml_at)) + bytes_of<std::uint64_t>(xml.size()) +
                             bytes_of(std::uint64_t{1024});
  return e57_pages(logical.replace(0, 48, header) + xml);
}

}  // namespace tactree::test
