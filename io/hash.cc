#include "io/hash.h"
#include <openssl/evp.h>
#include <array>
#include <memory>
#include <vector>
#include "io/input_file.h"

namespace scancal {

namespace {

using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

// Null if OpenSSL refuses the algorithm.
Context Begin() {
  Context context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  if (context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) context.reset();
  return context;
}

Result<std::string> Finish(const Context& context, bool ok, const std::string& name) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest = {};
  unsigned size = 0;
  ok = ok && EVP_DigestFinal_ex(context.get(), digest.data(), &size) == 1;
  if (!ok) return Error{name + ": its SHA-256 cannot be computed: OpenSSL refuses the algorithm"};
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr char kDigits[] = "0123456789abcdef";
    text += {kDigits[digest[i] >> 4U], kDigits[digest[i] & 15U]};
  }
  return text;
}

}  // namespace

Result<std::string> Sha256(const std::filesystem::path& path) {
  constexpr size_t kBlock = size_t{1} << 20;
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(path));
  const Context context = Begin();
  bool ok = context != nullptr;
  std::vector<char> buffer(kBlock);
  for (size_t count = kBlock; ok && count == kBlock;) {
    SCANCAL_ASSIGN_OR_RETURN(count, file.Read(buffer.data(), kBlock));
    ok = EVP_DigestUpdate(context.get(), buffer.data(), count) == 1;
  }
  return Finish(context, ok, file.name());
}

Result<std::string> Sha256OfText(std::string_view text) {
  const Context context = Begin();
  return Finish(context, context && EVP_DigestUpdate(context.get(), text.data(), text.size()) == 1, "text");
}

}  // namespace scancal
