#include "io/json_file.h"
#include <openssl/evp.h>
#include <algorithm>
#include <cmath>
#include <utility>
#include "io/input_file.h"
#include "io/message.h"
#include "io/output_file.h"

namespace scancal {
namespace {

// What JSON cannot hold, with the path of its key: "parameters[0].u is nan"; empty if there is nothing of the kind.
std::string FindUnwritable(const Json& json, const std::string& key) {
  if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    const double value = json.get<double>();
    return key + " is " + (std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
  }
  if (json.is_string() && FirstInvalidUtf8(json.get_ref<const std::string&>())) {
    return key + " is not UTF-8 text: " + Quoted(json.get_ref<const std::string&>());
  }
  std::string found;
  if (json.is_array()) {
    for (size_t i = 0; i < json.size() && found.empty(); ++i) {
      found = FindUnwritable(json[i], key + "[" + std::to_string(i) + "]");
    }
  }
  if (json.is_object()) {
    for (auto item = json.begin(); item != json.end() && found.empty(); ++item) {
      found = FirstInvalidUtf8(item.key()) ? key + " has a key that is not UTF-8: " + Quoted(item.key())
                                           : FindUnwritable(*item, key.empty() ? item.key() : key + "." + item.key());
    }
  }
  return found;
}

// A damaged file may be one long string.
std::string Short(const std::string& text) {
  constexpr size_t kMost = 120;
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

// "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ... - reason" -> "reason"
std::string ReasonOf(const std::string& message) {
  for (const std::string_view before : {" - ", ": ", "] "}) {
    if (const size_t at = message.find(before); at != std::string::npos)
      return Short(message.substr(at + before.size()));
  }
  return Short(message);
}

// Two spaces a level; a list of mere values stays on its line.
void Append(const Json& json, const std::string& indent, std::string* text) {
  const auto is_structured = [](const Json& each) { return each.is_structured(); };
  const bool values = json.is_array() && std::none_of(json.begin(), json.end(), is_structured);
  if (values || json.empty() || !json.is_structured()) {
    *text += json.dump();
    return;
  }
  const std::string inner = indent + "  ";
  *text += json.is_array() ? "[" : "{";
  const char* before = "\n";
  for (const auto& item : json.items()) {
    *text += before + inner;
    if (json.is_object()) *text += Json(item.key()).dump() + ": ";
    Append(item.value(), inner, text);
    before = ",\n";
  }
  *text += "\n" + indent + (json.is_array() ? "]" : "}");
}

constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr size_t kMost = size_t{1} << 30;  // OpenSSL counts in int
constexpr size_t kPiece = size_t{3} << 20;

const unsigned char* Unsigned(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

}  // namespace

Result<Json> ReadJson(const std::filesystem::path& path) {
  constexpr uintmax_t kMost = uintmax_t{1} << 30;
  std::error_code ignored;
  const uintmax_t size =
      std::filesystem::is_regular_file(path, ignored) ? std::filesystem::file_size(path, ignored) : 0;
  if (!ignored && size > kMost)
    return Error{path.string() + ": found " + std::to_string(size) + " bytes, expected at most 1 GiB of JSON"};
  SCANCAL_ASSIGN_OR_RETURN(const std::string file, ReadText(path));
  const std::string_view text = WithoutByteOrderMark(file);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    return Error{path.string() + ": the file is empty, expected JSON"};
  }
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const TextPlace place = PlaceOf(text, std::min(text.size(), error.byte > 0 ? error.byte - 1 : 0));
    return Error{path.string() + ":" + std::to_string(place.line) + ":" + std::to_string(place.column) +
                 ": not JSON: " + ReasonOf(error.what())};
  } catch (const Json::exception& error) {
    return Error{path.string() + ": not JSON: " + ReasonOf(error.what())};
  }
}

Result<void> WriteJson(const std::filesystem::path& path, const Json& json) {
  const std::string unwritable = FindUnwritable(json, "");
  if (!unwritable.empty()) return Error{path.string() + ": not written: " + unwritable + ", which JSON cannot hold"};
  std::string text;
  Append(json, "", &text);
  return WriteFile(path, text + "\n");
}

std::string ToBase64(std::string_view bytes) {
  std::string text;
  for (size_t at = 0; at < bytes.size(); at += kPiece) {
    const std::string_view block = bytes.substr(at, kPiece);
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
