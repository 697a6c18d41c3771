// What readers of scans in delimited text do alike.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>
#include "io/delimited.h"
#include "io/scan.h"

namespace scancal {

class CsvReader : public ScanReader {
 public:
  CsvReader(const ScanFormat& format, DelimitedText text)
      : format_(format),
        text_(std::move(text)),
        invalid_(format.invalid.value_or(std::numeric_limits<double>::infinity())) {}
  int64_t bytes_read() const override { return text_.bytes_read(); }
  int64_t bytes_total() const override { return text_.bytes_total(); }
  std::string Describe() const override { return text_.Describe(); }

 protected:
  // From here on only the wanted lines.
  void KeepLines() {
    if (format_.lines) text_.KeepLines(format_.lines->first, format_.lines->second);
  }
  // Neither below nor above it: equal, or nan.
  bool IsMissing(double number) const {
    return !std::islessgreater(number, invalid_) ||
           (!format_.more_invalid.empty() &&
            std::count(format_.more_invalid.begin(), format_.more_invalid.end(), number));
  }
  // The columns of `where`, and the values that rows are wanted with.
  Result<void> KeepWhere(const std::vector<std::string>& header) {
    SCANCAL_ASSIGN_OR_RETURN(auto where, ChooseWhere(format_, header, text_.Place()));
    text_.KeepWhere(std::move(where));
    return {};
  }

  // There were points, or none at all at the end of the file is an error.
  Result<bool> Taken(size_t points) {
    any_point_ |= points > 0;
    if (!any_point_ && missing_ == 0) return NoPoints(format_, text_.line(), text_.first_unwanted());
    return points > 0;
  }

  const ScanFormat format_;
  DelimitedText text_;

 private:
  double invalid_;  // infinite if there is none: numbers of the file are finite
  bool any_point_ = false;
};

// Reader: a CsvReader with Result<void> ReadHeader().
template <class Reader>
Result<std::unique_ptr<ScanReader>> OpenText(const ScanFormat& format, Result<DelimitedText> text) {
  if (!text.ok()) return text.error();
  auto reader = std::make_unique<Reader>(format, *std::move(text));
  SCANCAL_RETURN_IF_ERROR(reader->ReadHeader());
  return std::unique_ptr<ScanReader>(std::move(reader));
}

}  // namespace scancal
