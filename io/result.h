// A value, or one clear sentence that says why there is none: place, what was found, what was expected, remedy.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace scancal {

// What the world did wrong (a file, a flag, a scene), in words for the person who can mend it.
// Our own mistakes are CHECKs; unhappy numbers are a field of the Calibration. kind: what a caller may act on; nobody
// compares messages.
enum class ErrorKind { kOther, kMissingColumns, kUnknownLayout };

struct Error {
  std::string message;
  ErrorKind kind = ErrorKind::kOther;
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor): `return value;`
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor): `return Error{...};`
  bool ok() const { return state_.index() == 0; }
  const Error& error() const { return std::get<1>(state_); }
  T& operator*() & { return std::get<0>(state_); }
  const T& operator*() const& { return std::get<0>(state_); }
  T&& operator*() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor): `return Error{...};`
  bool ok() const { return !error_.has_value(); }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace scancal

// NOLINTBEGIN(bugprone-macro-parentheses): a declaration cannot stand in parentheses
#define SCANCAL_CONCAT_INNER(a, b) a##b
#define SCANCAL_CONCAT(a, b) SCANCAL_CONCAT_INNER(a, b)

// SCANCAL_ASSIGN_OR_RETURN(const Table table, ReadTable(path)): the value, or out of this function with the error.
#define SCANCAL_ASSIGN_OR_RETURN(declaration, expression) \
  SCANCAL_ASSIGN_OR_RETURN_INNER(SCANCAL_CONCAT(result_, __LINE__), declaration, expression)
#define SCANCAL_ASSIGN_OR_RETURN_INNER(result, declaration, expression) \
  auto result = (expression);                                           \
  if (!result.ok()) return result.error();                              \
  declaration = *std::move(result)

#define SCANCAL_RETURN_IF_ERROR(expression) SCANCAL_RETURN_IF_ERROR_INNER(SCANCAL_CONCAT(result_, __LINE__), expression)
#define SCANCAL_RETURN_IF_ERROR_INNER(result, expression) \
  if (auto result = (expression); !result.ok()) return result.error()
// NOLINTEND(bugprone-macro-parentheses)
