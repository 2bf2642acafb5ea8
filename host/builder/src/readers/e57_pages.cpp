#include "e57_pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cstring>

#include "readers.hpp"
#include "scalar.hpp"

namespace tactree::builder {
namespace {

using Crc32c = boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true>;

}  // namespace

std::uint64_t E57Pages::to_logical(std::uint64_t physical, const std::string& what) const {
  const std::uint64_t in_page = physical % kPageBytes;
  if (in_page >= kDataBytes || physical / kPageBytes >= file_.size() / kPageBytes) {
    throw ReadError(
        file_.name(), "",
        fmt::format("{} are declared to begin at byte {}, where the file of {} bytes has no data",
                    what, physical, file_.size()),
        kCopyAgain);
  }
  return physical / kPageBytes * kDataBytes + in_page;
}

void E57Pages::seek(std::uint64_t logical) {
  const std::uint64_t page = logical / kDataBytes;
  loaded_ = loaded_ && page == page_;
  page_ = page;
  at_ = logical % kDataBytes;
}

void E57Pages::read(char* to, std::size_t count) {
  while (count > 0) {
    if (at_ == kDataBytes) seek(offset());
    if (!loaded_) load();
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(count, kDataBytes - at_));
    std::memcpy(to, data_.data() + at_, part);
    to += part;
    count -= part;
    at_ += part;
  }
}

void E57Pages::load() {
  const std::uint64_t begin = page_ * kPageBytes;
  if (file_.offset() > begin) file_.rewind();
  file_.skip(begin - file_.offset());
  const std::string_view page = file_.peek(kPageBytes);
  const std::string place = fmt::format("page {} (byte {})", page_ + 1, begin);
  if (page.size() < kPageBytes) {
    throw ReadError(file_.name(), place, "the file ends too early", kCopyAgain);
  }
  Crc32c crc;
  crc.process_bytes(page.data(), kDataBytes);
  const auto stored = load_bits<std::uint32_t, true>(page.data() + kDataBytes);
  if (crc.checksum() != stored) {
    throw ReadError(file_.name(), place,
                    fmt::format("the page is damaged: its checksum is {:08x}, that of its data "
                                "{:08x}",
                                stored, crc.checksum()),
                    kCopyAgain);
  }
  std::memcpy(data_.data(), page.data(), kDataBytes);
  file_.consume(kPageBytes);
  loaded_ = true;
}

}  // namespace tactree::builder
