// libFuzzer's entry to the reader that the environment names: scripts/fuzz.
#include <cstdio>
#include <cstring>
#include "tests/fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const scancal::FuzzedReader* const reader = [] {
    const char* const name = std::getenv("SCANCAL_READER");
    for (const scancal::FuzzedReader& each : scancal::kFuzzedReaders)
      if (name != nullptr && std::strcmp(each.name, name) == 0) return &each;
    std::fprintf(stderr, "SCANCAL_READER: expected the name of a reader\n");
    std::exit(1);
  }();
  reader->read({reinterpret_cast<const char*>(data), size});
  return 0;
}
