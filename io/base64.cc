#include "io/base64.h"
#include <openssl/evp.h>
#include "io/message.h"

namespace scancal {
namespace {

constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr size_t kMost = size_t{1} << 30;  // OpenSSL counts in int
constexpr size_t kBlock = size_t{3} << 20;

const unsigned char* Unsigned(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

}  // namespace

std::string ToBase64(std::string_view bytes) {
  std::string text;
  for (size_t at = 0; at < bytes.size(); at += kBlock) {
    const std::string_view block = bytes.substr(at, kBlock);
    const size_t filled = text.size();
    text.resize(filled + (block.size() + 2) / 3 * 4 + 1);  // and the zero that OpenSSL appends
    const int written = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()) + filled, Unsigned(block),
                                        static_cast<int>(block.size()));
    text.resize(filled + static_cast<size_t>(written));
  }
  return text;
}

Result<std::string> FromBase64(std::string_view text) {
  if (text.size() > kMost) return Error{"found " + std::to_string(text.size()) + " characters, expected at most 2^30"};
  // OpenSSL takes blanks around the text and '=' anywhere.
  const size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
  const size_t odd = text.substr(0, text.size() - padding).find_first_not_of(kAlphabet);
  if (odd != std::string_view::npos)
    return Error{"found " + Quoted(text.substr(odd, 1)) + " as character " + std::to_string(odd + 1) +
                 ", expected base64"};
  if (text.size() % 4 != 0)
    return Error{"found " + std::to_string(text.size()) + " characters, expected base64, a multiple of four"};
  std::string bytes(text.size() / 4 * 3, '\0');
  EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()), Unsigned(text), static_cast<int>(text.size()));
  bytes.resize(bytes.size() - padding);
  return bytes;
}

}  // namespace scancal
