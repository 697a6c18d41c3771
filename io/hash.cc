#include "io/hash.h"
#include <openssl/evp.h>
#include <array>
#include <memory>
#include <vector>
#include "io/input_file.h"

namespace scancal {

Result<std::string> Sha256(const std::filesystem::path& path) {
  constexpr size_t kBlock = size_t{1} << 20;
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(path));
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool ok = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> buffer(kBlock);
  for (size_t count = kBlock; ok && count == kBlock;) {
    SCANCAL_ASSIGN_OR_RETURN(count, file.Read(buffer.data(), kBlock));
    ok = EVP_DigestUpdate(context.get(), buffer.data(), count) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest = {};
  unsigned size = 0;
  ok = ok && EVP_DigestFinal_ex(context.get(), digest.data(), &size) == 1;
  if (!ok) return Error{file.name() + ": its SHA-256 cannot be computed: OpenSSL refuses the algorithm"};
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr char kDigits[] = "0123456789abcdef";
    text += {kDigits[digest[i] >> 4U], kDigits[digest[i] & 15U]};
  }
  return text;
}

}  // namespace scancal
