#pragma once
// tactree.Model.

#include <pybind11/numpy.h>

#include <memory>
#include <span>
#include <string>

#include "tactree/support/blob_file.hpp"

namespace tactree::python {

class Model {
 public:
  /// `report` is the JSON text of the build; empty if the model was loaded.
  Model(support::BlobFile blob, std::string file, std::string report = "")
      : blob_(std::make_shared<const support::BlobFile>(std::move(blob))),
        file_(std::move(file)),
        report_(std::move(report)) {}

  [[nodiscard]] const core::BlobView& view() const { return blob_->view(); }
  [[nodiscard]] std::span<const std::byte> bytes() const { return blob_->bytes(); }
  [[nodiscard]] const std::shared_ptr<const support::BlobFile>& blob() const { return blob_; }
  /// Name in messages.
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& report() const { return report_; }

  /// Decoded once, when they are first needed; read-only.
  [[nodiscard]] pybind11::array points();
  [[nodiscard]] pybind11::array normals();

 private:
  void decode();

  std::shared_ptr<const support::BlobFile> blob_;
  std::string file_;
  std::string report_;
  pybind11::object points_;
  pybind11::object normals_;
};

}  // namespace tactree::python
