// Reads JSON from untrusted files. Error messages contain the position in the document.
#pragma once

#include <cstddef>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace postlens {

/// Parses a document. Throws Error(invalid_input) if it is not valid JSON, nests more than 128 levels or
/// has more than 4 million values. A value needs about 100 bytes of memory.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, const std::string& file);

/// A JSON value together with its position in the document, such as "materials[2].emissiveFactor". Keeps
/// references to the document and to the name of the file.
///
/// The member functions that read a key return an empty value if the key is missing. If the value has a wrong
/// type or is out of range, they throw Error(invalid_input) with the message "FILE: PLACE problem (got X;
/// expected Y)".
class JsonPlace {
  public:
    JsonPlace(const std::string& file, const nlohmann::json& value, std::string where)
        : file_(&file), value_(&value), where_(std::move(where)) {}

    [[nodiscard]] const nlohmann::json& value() const { return *value_; }
    [[nodiscard]] const std::string& where() const { return where_; }
    [[nodiscard]] bool has(const char* key) const { return value_->contains(key); }

    /// `object` returns the JSON object under `key`. `objects` returns all elements of the array of JSON
    /// objects under `key`.
    [[nodiscard]] std::optional<JsonPlace> object(const char* key) const;
    [[nodiscard]] std::vector<JsonPlace> objects(const char* key) const;  ///< empty if the key is missing
    /// extensions.NAME
    [[nodiscard]] std::optional<JsonPlace> extension(const char* name) const;

    [[nodiscard]] std::optional<double> number(const char* key, double least, double most) const;
    /// Returns a whole number.
    [[nodiscard]] std::optional<std::size_t> whole(const char* key, std::size_t least,
                                                   std::size_t most) const;
    /// Returns an index into an array of `count` elements.
    [[nodiscard]] std::optional<std::size_t> index(const char* key, std::size_t count) const;
    [[nodiscard]] std::vector<std::size_t> indices(const char* key, std::size_t count) const;
    [[nodiscard]] std::optional<std::vector<double>> numbers(const char* key, std::size_t count, double least,
                                                             double most) const;
    [[nodiscard]] std::optional<std::string> text(const char* key) const;
    [[nodiscard]] std::vector<std::string> texts(const char* key) const;
    [[nodiscard]] bool flag(const char* key, bool otherwise) const;

    template <typename T>
    [[nodiscard]] T required(std::optional<T> found, const char* key) const {
        if (!found) fail_here("has no '{}' (expected one)", key);
        return std::move(*found);
    }

    template <typename... Args>
    [[noreturn]] void fail_here(fmt::format_string<Args...> format, Args&&... args) const {
        fail(ExitCode::invalid_input, "{}: {} {}", *file_, where_,
             fmt::format(format, std::forward<Args>(args)...));
    }

  private:
    [[nodiscard]] const nlohmann::json* find(const char* key) const;
    [[nodiscard]] JsonPlace below(const char* key, const nlohmann::json& value) const;
    [[nodiscard]] std::size_t as_index(const nlohmann::json& value, std::size_t count) const;

    const std::string* file_;
    const nlohmann::json* value_;
    std::string where_;
};

}  // namespace postlens
