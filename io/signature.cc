#include "io/signature.h"
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <algorithm>
#include "io/input_file.h"
#include "io/output_file.h"

namespace scancal {
namespace {

namespace fs = std::filesystem;
using DigestContext = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

fs::path SignatureOf(fs::path file) { return file += ".sig"; }

const unsigned char* Bytes(const std::string& text) { return reinterpret_cast<const unsigned char*>(text.data()); }

// PEM_read_bio_PrivateKey or PEM_read_bio_PUBKEY.
Result<std::shared_ptr<EVP_PKEY>> ReadKey(const fs::path& pem, decltype(&PEM_read_bio_PUBKEY) read,
                                          const char* expected) {
  SCANCAL_ASSIGN_OR_RETURN(const std::string text, ReadText(pem));
  const std::unique_ptr<BIO, decltype(&BIO_free)> memory(
      BIO_new_mem_buf(text.data(), static_cast<int>(std::min<size_t>(text.size(), 1 << 20))), &BIO_free);
  EVP_PKEY* const key = read(memory.get(), nullptr, nullptr, nullptr);
  if (key == nullptr) return Error{pem.string() + ": found no key, expected " + expected};
  return std::shared_ptr<EVP_PKEY>(key, &EVP_PKEY_free);
}

}  // namespace

Result<SigningKey> SigningKey::Read(const fs::path& pem) {
  SCANCAL_ASSIGN_OR_RETURN(auto key, ReadKey(pem, &PEM_read_bio_PrivateKey,
                                             "a private key in PEM, as openssl genpkey -algorithm ed25519 makes one"));
  return SigningKey(pem.string(), std::move(key));
}

Result<SigningKey> SigningKey::ReadPublic(const fs::path& pem) {
  SCANCAL_ASSIGN_OR_RETURN(
      auto key, ReadKey(pem, &PEM_read_bio_PUBKEY, "a public key in PEM, as openssl pkey -pubout makes one"));
  return SigningKey(pem.string(), std::move(key));
}

Result<void> SigningKey::Sign(const fs::path& file) const {
  SCANCAL_ASSIGN_OR_RETURN(const std::string text, ReadText(file));
  const DigestContext context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  size_t size = 0;
  const auto sign = [&](unsigned char* to) {
    return EVP_DigestSign(context.get(), to, &size, Bytes(text), text.size()) == 1;
  };
  std::string signature;
  bool ok =
      context && EVP_DigestSignInit_ex(context.get(), nullptr, nullptr, nullptr, nullptr, key_.get(), nullptr) == 1;
  ok = ok && sign(nullptr);
  signature.resize(size);
  ok = ok && sign(reinterpret_cast<unsigned char*>(signature.data()));
  if (!ok) return Error{name_ + ": OpenSSL does not sign with this kind of key, expected Ed25519"};
  signature.resize(size);
  return WriteFile(SignatureOf(file), signature);
}

Result<void> SigningKey::Verify(const fs::path& file) const {
  SCANCAL_ASSIGN_OR_RETURN(const std::string text, ReadText(file));
  SCANCAL_ASSIGN_OR_RETURN(const std::string signature, ReadText(SignatureOf(file)));
  const DigestContext context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  const bool ok =
      context && EVP_DigestVerifyInit_ex(context.get(), nullptr, nullptr, nullptr, nullptr, key_.get(), nullptr) == 1 &&
      EVP_DigestVerify(context.get(), Bytes(signature), signature.size(), Bytes(text), text.size()) == 1;
  if (ok) return {};
  return Error{file.string() + ": its signature in " + SignatureOf(file).filename().string() +
               " is not one of these bytes by the key of " + name_ +
               ": the file was changed, or another key signed it"};
}

}  // namespace scancal
