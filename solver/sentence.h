// What the program says of a result, in each language of the report.
#pragma once
#include <fmt/format.h>
#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>

namespace scancal {

// As it was said. Without German and id: words of others (Ceres's, a name, an old file's), which stay as they are.
struct Sentence {
  std::string english = {}, german = {}, id = {};

  bool empty() const { return english.empty(); }
  operator const std::string&() const { return english; }  // NOLINT(google-explicit-constructor): all but the page
  bool operator==(const Sentence&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const Sentence& sentence) { return out << sentence.english; }
};

// An argument as German has it: a number with a decimal comma, a Sentence in its German.
template <class T>
struct InGerman {
  const T& value;
};

// A sentence with places for arguments of these types, in fmt's notation and the same order in both languages; an
// argument may itself be a Sentence. What does not fit does not compile. Messages are constants beside the code that
// speaks. id: the room and the name of the constant, "solver.too_few_views" of kTooFewViews, so that it is there once.
template <class... Args>
struct Message {
  consteval Message(std::string_view id_, std::string_view english_, std::string_view german_)
      : id(id_), english(english_), german(german_) {
    if (Places(english_) != sizeof...(Args) || Places(german_) != sizeof...(Args)) throw "expected {} once an argument";
  }

  std::string_view id;
  fmt::format_string<const Args&...> english;
  fmt::format_string<InGerman<Args>...> german;

 private:
  static constexpr size_t Places(std::string_view text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '{'));
  }
};

template <class... Args>
Sentence Say(const Message<Args...>& message, const std::type_identity_t<Args>&... arguments) {
  return {fmt::format(message.english, arguments...), fmt::format(message.german, InGerman<Args>{arguments}...),
          std::string(message.id)};
}

}  // namespace scancal

template <>
struct fmt::formatter<scancal::Sentence> : fmt::formatter<fmt::string_view> {
  auto format(const scancal::Sentence& sentence, format_context& context) const {
    return formatter<fmt::string_view>::format(sentence.english, context);
  }
};

template <class T>
struct fmt::formatter<scancal::InGerman<T>> : fmt::formatter<T> {
  auto format(const scancal::InGerman<T>& argument, format_context& context) const {
    if constexpr (std::is_same_v<T, scancal::Sentence>) {
      const scancal::Sentence& sentence = argument.value;
      return fmt::formatter<fmt::string_view>::format(sentence.id.empty() ? sentence.english : sentence.german,
                                                      context);
    } else if constexpr (std::is_floating_point_v<T>) {
      fmt::memory_buffer text;
      fmt::format_context into(fmt::appender(text), {});
      fmt::formatter<T>::format(argument.value, into);
      std::replace(text.begin(), text.end(), '.', ',');
      return std::copy(text.begin(), text.end(), context.out());
    } else {
      return fmt::formatter<T>::format(argument.value, context);
    }
  }
};
