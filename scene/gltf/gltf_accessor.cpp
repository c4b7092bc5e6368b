#include "scene/gltf/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "core/text.h"

namespace postlens {
namespace {

// Largest total number of values in all accessors (typed arrays) of a glTF document: 1 GiB as floats.
constexpr std::size_t most_numbers = std::size_t{1} << 28;
// Largest number of elements of a glTF accessor without a buffer. All its elements are 0 and take no space in
// the file, so a tiny file could demand any amount of memory.
constexpr std::size_t most_zeros = std::size_t{1} << 24;

enum Component : unsigned {
    int8 = 5120,
    uint8 = 5121,
    int16 = 5122,
    uint16 = 5123,
    uint32 = 5125,
    float32 = 5126
};

std::size_t bytes_of(unsigned component) {
    switch (component) {
        case int8:
        case uint8:
            return 1;
        case int16:
        case uint16:
            return 2;
        case uint32:
        case float32:
            return 4;
        default:
            return 0;
    }
}

template <typename T>
T raw(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

// Converts a normalised integer c to c / max, but at least -1 [gltf2, section 3.11].
template <typename T>
float scaled(const char* at, bool normalised) {
    const auto value = static_cast<float>(raw<T>(at));
    return normalised ? std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0F) : value;
}

float number(const char* at, unsigned component, bool normalised) {
    switch (component) {
        case int8:
            return scaled<std::int8_t>(at, normalised);
        case uint8:
            return scaled<std::uint8_t>(at, normalised);
        case int16:
            return scaled<std::int16_t>(at, normalised);
        case uint16:
            return scaled<std::uint16_t>(at, normalised);
        case uint32:
            return scaled<std::uint32_t>(at, normalised);
        default:
            return raw<float>(at);
    }
}

std::uint32_t whole(const char* at, unsigned component) {
    if (component == uint8) return raw<std::uint8_t>(at);
    if (component == uint16) return raw<std::uint16_t>(at);
    return raw<std::uint32_t>(at);
}

std::size_t components_of(const std::string& type) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 4> types{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}};
    for (const auto& [name, components] : types) {
        if (type == name) return components;
    }
    return 0;
}

}  // namespace

struct GltfAccessors::Layout {
    std::size_t count = 0, components = 1, stride = 0;
    unsigned component = float32;
    bool normalised = false;
    std::optional<std::string_view> bytes;  // from the first element on; if absent, all elements are zero
};

namespace {

unsigned component_type(const JsonPlace& place) {
    const auto type =
        static_cast<unsigned>(place.required(place.whole("componentType", 0, 65535), "componentType"));
    if (bytes_of(type) == 0) place.fail_here("has an unknown componentType (got {})", type);
    return type;
}

// Returns the bytes of `count` elements of `size` bytes in a buffer view, `stride` bytes apart.
std::string_view elements(const GltfDocument& d, const JsonPlace& place, std::size_t view, std::size_t count,
                          std::size_t size, std::size_t stride) {
    const std::size_t offset = place.whole("byteOffset", 0, largest_gltf_bytes).value_or(0);
    const std::string_view all = d.view(view);
    const std::size_t end = offset + (count - 1) * stride + size;
    if (end > all.size()) {
        place.fail_here("runs over its buffer view's end (got bytes up to {}; expected at most {})", end,
                        all.size());
    }
    return all.substr(offset, end - offset);
}

}  // namespace

GltfAccessors::Layout GltfAccessors::layout(std::size_t index, const JsonPlace& user) {
    const JsonPlace a = document_.item("accessors", index);
    Layout out;
    out.count = a.required(a.whole("count", 1, std::numeric_limits<std::uint32_t>::max() - 1), "count");
    const std::string type = a.required(a.text("type"), "type");
    out.components = components_of(type);
    if (out.components == 0) {
        user.fail_here("refers to {} of a type that does not fit (got {})", a.where(), excerpt(type));
    }
    out.component = component_type(a);
    out.normalised = a.flag("normalized", false);
    const std::size_t size = out.components * bytes_of(out.component);
    const auto view = a.index("bufferView", document_.count("bufferViews"));
    if (view) {
        const JsonPlace v = document_.item("bufferViews", *view);
        out.stride = v.whole("byteStride", 4, 252).value_or(size);
        if (out.stride < size) {
            v.fail_here("has elements that overlap (got a byteStride of {}; expected at least {})",
                        out.stride, size);
        }
        out.bytes = elements(document_, a, *view, out.count, size, out.stride);
    } else if (out.count > most_zeros) {
        a.fail_here("has too many elements without a bufferView (got {}; expected at most {})", out.count,
                    most_zeros);
    }
    return out;
}

void GltfAccessors::spend(std::size_t numbers, const JsonPlace& place) {
    spent_ += numbers;
    if (spent_ > most_numbers) {
        place.fail_here("makes too much (expected at most {} numbers in all accessors that are used)",
                        most_numbers);
    }
}

GltfValues GltfAccessors::floats(std::size_t index, std::initializer_list<std::size_t> components,
                                 const JsonPlace& place) {
    const Layout l = layout(index, place);
    const JsonPlace a = document_.item("accessors", index);
    if (std::find(components.begin(), components.end(), l.components) == components.end()) {
        place.fail_here("refers to {} of a type that does not fit (got {} components; expected {})",
                        a.where(), l.components, fmt::join(components, " or "));
    }
    spend(l.count * l.components, place);
    GltfValues out{l.count, l.components, std::vector<float>(l.count * l.components, 0.0F)};
    if (l.bytes) {
        const std::size_t size = bytes_of(l.component);
        for (std::size_t i = 0; i < l.count; ++i) {
            for (std::size_t k = 0; k < l.components; ++k) {
                out.values[i * l.components + k] =
                    number(l.bytes->data() + i * l.stride + k * size, l.component, l.normalised);
            }
        }
    }
    fill_sparse(a, l, out);
    const auto bad =
        std::find_if(out.values.begin(), out.values.end(), [](float v) { return !std::isfinite(v); });
    if (bad != out.values.end()) {
        a.fail_here("holds a number that is not finite (got {} in element {})", *bad,
                    static_cast<std::size_t>(bad - out.values.begin()) / l.components);
    }
    return out;
}

void GltfAccessors::fill_sparse(const JsonPlace& accessor, const Layout& l, GltfValues& out) {
    const auto sparse = accessor.object("sparse");
    if (!sparse) return;
    const std::size_t count = sparse->required(sparse->whole("count", 1, l.count), "count");
    const JsonPlace at = sparse->required(sparse->object("indices"), "indices");
    const JsonPlace values = sparse->required(sparse->object("values"), "values");
    const std::size_t views = document_.count("bufferViews");
    const unsigned index_type = component_type(at);
    if (index_type != uint8 && index_type != uint16 && index_type != uint32) {
        at.fail_here("has no index type (got {}; expected 5121, 5123 or 5125)", index_type);
    }
    const std::size_t index_size = bytes_of(index_type), size = bytes_of(l.component);
    const std::string_view where =
        elements(document_, at, at.required(at.index("bufferView", views), "bufferView"), count, index_size,
                 index_size);
    const std::string_view what =
        elements(document_, values, values.required(values.index("bufferView", views), "bufferView"), count,
                 size * l.components, size * l.components);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t element = whole(where.data() + i * index_size, index_type);
        if (element >= l.count) {
            at.fail_here("is out of range (got {}; expected less than {})", element, l.count);
        }
        for (std::size_t k = 0; k < l.components; ++k) {
            out.values[element * l.components + k] =
                number(what.data() + (i * l.components + k) * size, l.component, l.normalised);
        }
    }
}

std::vector<std::uint32_t> GltfAccessors::indices(std::size_t index, std::size_t limit,
                                                  const JsonPlace& place) {
    const Layout l = layout(index, place);
    const JsonPlace a = document_.item("accessors", index);
    if (l.components != 1 || (l.component != uint8 && l.component != uint16 && l.component != uint32)) {
        place.fail_here("refers to {} that holds no indices (expected SCALAR unsigned integers)", a.where());
    }
    if (!l.bytes || a.has("sparse"))
        a.fail_here("has indices without a buffer (expected a bufferView alone)");
    spend(l.count, place);
    std::vector<std::uint32_t> out(l.count);
    for (std::size_t i = 0; i < l.count; ++i) {
        out[i] = whole(l.bytes->data() + i * l.stride, l.component);
        if (out[i] >= limit) {
            a.fail_here("holds an index out of range (got {} in element {}; expected less than {})", out[i],
                        i, limit);
        }
    }
    return out;
}

}  // namespace postlens
