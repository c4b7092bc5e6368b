// Reads values of given types from the tables of a TOML file. If a value is missing or wrong, the error names
// the line and column in the file. Include this header only in .cpp files that read TOML, because it includes
// the library toml++, which takes seconds to compile.
#pragma once

#include <filesystem>
#include <fmt/format.h>
#include <glm/glm.hpp>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

#include "core/error.h"

namespace postlens {

/// Parses the text of a TOML file. `file` is its name in error messages. Throws Error(invalid_input)
/// "FILE:LINE:COLUMN: ...".
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::string& file);

/// The legal range of a number. NaN is never legal.
struct NumberRange {
    double min = -std::numeric_limits<double>::max();
    double max = std::numeric_limits<double>::max();
    bool may_be_infinite = false;  ///< +inf is legal although it is above max
    bool excludes_min = false;     ///< min itself is not legal
};

/// A table of a TOML file. It knows its name and its position in the file, for error messages.
class TomlTable {
  public:
    /// `what` is the name of the table in error messages, for example "object 'ball'".
    TomlTable(const std::string& file, const toml::table& table, std::string what)
        : file_(&file), table_(&table), what_(std::move(what)) {}

    [[nodiscard]] const std::string& what() const { return what_; }
    void rename(std::string what) { what_ = std::move(what); }

    /// Throws if the table contains a key that is in none of the lists in `known`. Such a key is probably
    /// misspelled. The error therefore names the key and the known key that is most similar to it.
    void allow_only(std::initializer_list<std::span<const std::string_view>> known) const;
    [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }

    // The following functions return nothing if the key is absent. They throw if the value has the wrong type
    // or is out of range.
    [[nodiscard]] std::optional<double> number(std::string_view key, const NumberRange& range = {}) const;
    [[nodiscard]] std::optional<int> integer(std::string_view key, int min, int max) const;
    [[nodiscard]] std::optional<bool> flag(std::string_view key) const;
    /// Returns a printable text of 1 to 255 bytes.
    [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
    /// Returns the index in `choices` of the key's value, which must be a text. For an unknown text, the
    /// error names the most similar choice.
    [[nodiscard]] std::optional<std::size_t> choice(std::string_view key,
                                                    std::span<const std::string_view> choices) const;
    [[nodiscard]] std::optional<glm::dvec3> vec3(std::string_view key, const NumberRange& range = {}) const;
    /// Returns an array of exactly `count` numbers.
    [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count,
                                                             const NumberRange& range = {}) const;
    /// Returns an array of numbers of any length. It is empty if the key is absent.
    [[nodiscard]] std::vector<double> number_list(std::string_view key, const NumberRange& range = {}) const;
    [[nodiscard]] bool is_array(std::string_view key) const;
    /// Returns three numbers. In the file, a single number may stand for three equal ones.
    [[nodiscard]] std::optional<glm::dvec3> number_or_vec3(std::string_view key,
                                                           const NumberRange& range = {}) const;
    /// Returns an array of arrays of numbers, such as points, each with min_columns to max_columns numbers.
    [[nodiscard]] std::optional<std::vector<std::vector<double>>> rows(std::string_view key,
                                                                       std::size_t min_columns,
                                                                       std::size_t max_columns,
                                                                       const NumberRange& range = {}) const;
    /// Returns an array of texts. In the file, a single text may stand for an array of one.
    [[nodiscard]] std::optional<std::vector<std::string>> texts(std::string_view key) const;
    [[nodiscard]] std::optional<TomlTable> table(std::string_view key) const;
    /// Returns an array of tables, written as [[key]] or as [{...}, ...]. It is empty if the key is absent.
    /// Error messages name each table by `what` and its number.
    [[nodiscard]] std::vector<TomlTable> tables(std::string_view key, std::string_view what) const;

    /// Returns the value of a required key, or throws if it is absent. Example:
    /// required(t.number("radius_m"), "radius_m").
    template <typename T>
    [[nodiscard]] T required(std::optional<T> value, std::string_view key) const {
        if (!value) fail_here("has no '{}' (expected one)", key);
        return *std::move(value);
    }
    /// Throws if both keys are present, because they set the same value in different ways.
    void refuse_both(std::string_view a, std::string_view b) const;

    /// Throws Error(invalid_input) "FILE:LINE:COLUMN: WHAT: ...", where LINE and COLUMN are the position of
    /// the value of `key` in the TOML file. WHAT describes the table (group of keys) that contains `key`.
    template <typename... Args>
    [[noreturn]] void fail_at(std::string_view key, fmt::format_string<Args...> format,
                              Args&&... args) const {
        fail_at_node(*table_->get(key), fmt::format(format, std::forward<Args>(args)...));
    }
    /// Throws Error(invalid_input) "FILE:LINE:COLUMN: WHAT: ..." with the position of the table.
    template <typename... Args>
    [[noreturn]] void fail_here(fmt::format_string<Args...> format, Args&&... args) const {
        fail_at_node(*table_, fmt::format(format, std::forward<Args>(args)...));
    }
    /// Returns "FILE:LINE:COLUMN" of the key's value, for messages that are not errors.
    [[nodiscard]] std::string place(std::string_view key) const;
    /// Returns "FILE:LINE" of the table itself.
    [[nodiscard]] std::string line() const;

  private:
    [[noreturn]] void fail_at_node(const toml::node& node, const std::string& text) const;
    [[nodiscard]] double number_of(const toml::node& node, std::string_view key,
                                   const NumberRange& range) const;
    [[nodiscard]] std::string text_of(const toml::node& node, std::string_view key) const;
    [[nodiscard]] std::vector<double> numbers_of(const toml::node& node, std::string_view key,
                                                 std::size_t count, const NumberRange& range) const;
    [[nodiscard]] const toml::array& array_of(const toml::node& node, std::string_view key,
                                              std::string_view of) const;

    const std::string* file_;
    const toml::table* table_;
    std::string what_;
};

}  // namespace postlens
