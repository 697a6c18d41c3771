// Scan files read to their end, for tests.
#pragma once
#include <string>
#include <vector>
#include "io/scan.h"
#include "tests/io/temporary_folder.h"

namespace scancal {

struct Scan {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  int64_t missing = 0;
  std::string error;  // empty: none
};

inline Scan ReadAll(const ScanFormat& format) {
  Scan scan;
  auto reader = ScanReader::Open(format);
  if (!reader.ok()) {
    scan.error = reader.error().message;
    return scan;
  }
  ScanBatch batch;
  for (;;) {
    const auto more = (*reader)->Next(&batch);
    scan.names = batch.names;
    scan.columns.resize(batch.columns.size());
    scan.missing = (*reader)->missing();
    if (!more.ok()) scan.error = more.error().message;
    if (!more.ok() || !*more) return scan;
    for (size_t i = 0; i < batch.columns.size(); ++i) {
      scan.columns[i].insert(scan.columns[i].end(), batch.columns[i].begin(), batch.columns[i].end());
    }
  }
}

}  // namespace scancal
