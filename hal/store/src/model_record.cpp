// Loop and memory annotations: docs/BOUND.md.

#include "tactree/store/model_record.hpp"

#include "tactree/core/math/crc32.hpp"

namespace tactree::store {

std::uint32_t checksum_of(const ModelRecord& record) {
  const auto bytes = std::as_bytes(std::span(&record, 1));
  return core::crc32(bytes.first(sizeof record - sizeof record.checksum));
}

bool is_valid(const ModelRecord& record, std::uint32_t slot_bytes) {
  return record.magic == kRecordMagic && record.checksum == checksum_of(record) &&
         (record.active < kStoreSlots || record.active == kFactorySlot) &&
         record.slot[0].bytes <= slot_bytes && record.slot[1].bytes <= slot_bytes;
}

void apply_saved_parameters(const float* saved, core::Configuration& configuration) {
  for (std::uint32_t i = 0; saved != nullptr && i < core::kParameters; ++i) {  // bound: kParameters
    (void)core::set_parameter(configuration, i, saved[i]);
  }
}

}  // namespace tactree::store
