// Detached signatures: FILE.sig beside a file, which `openssl pkeyutl -verify -rawin` reads as well.
#pragma once
#include <filesystem>
#include <memory>
#include "io/result.h"

struct evp_pkey_st;

namespace scancal {

// A key in PEM: Ed25519 or any other that OpenSSL signs with (RSA and EC with SHA-256). One with a passphrase asks for
// it at the terminal.
class SigningKey {
 public:
  static Result<SigningKey> Read(const std::filesystem::path& pem);        // a private key
  static Result<SigningKey> ReadPublic(const std::filesystem::path& pem);  // verifies only
  // Writes FILE.sig over all bytes of the file.
  Result<void> Sign(const std::filesystem::path& file) const;
  // An Error where FILE.sig is missing, or is not the signature of these bytes by this key.
  Result<void> Verify(const std::filesystem::path& file) const;

 private:
  SigningKey(std::string name, std::shared_ptr<evp_pkey_st> key) : name_(std::move(name)), key_(std::move(key)) {}
  std::string name_;
  std::shared_ptr<evp_pkey_st> key_;
};

}  // namespace scancal
