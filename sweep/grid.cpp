#include "sweep/grid.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>

#include "core/error.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/read_prescription.h"
#include "sweep/values.h"

namespace postlens {
namespace {

/// Formats the values with as few digits as keep them distinct, at least `digits`.
template <typename Value, typename Format>
std::vector<std::string> distinct_labels(const std::vector<Value>& values, int digits, const Format& format) {
    std::vector<std::string> out;
    for (; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
        out.clear();
        for (const Value& v : values) out.push_back(format(v, digits));
        if (std::set<std::string>(out.begin(), out.end()).size() == values.size()) break;
    }
    return out;
}

std::vector<std::string> labels_of(const std::vector<double>& values) {
    return distinct_labels(values, 4, [](double v, int digits) { return fmt::format("{:.{}g}", v, digits); });
}

/// Names each impulse response with letters, digits, dots and dashes. Numbers distinguish equal names.
std::vector<std::string> labels_of(const std::vector<Impulse>& impulses) {
    std::vector<std::string> out;
    for (const Impulse& i : impulses) {
        const bool of_file = i.kind == ImpulseKind::picture || i.kind == ImpulseKind::lens;
        std::string label = of_file ? i.file.stem().string() : impulse_text(i);
        for (char& c : label) {
            if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.') c = '-';
        }
        out.push_back(label);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (std::count(out.begin(), out.end(), out[i]) > 1) out[i] = fmt::format("{}-{}", i + 1, out[i]);
    }
    return out;
}

/// Names each shutter: "0to0.02" is open from 0 s to 0.02 s.
std::vector<std::string> labels_of(const std::vector<TimeSpan>& spans) {
    return distinct_labels(spans, 6, [](const TimeSpan& s, int digits) {
        return fmt::format("{:.{}g}to{:.{}g}", s.open_s, digits, s.close_s, digits);
    });
}

struct LensValues {
    std::vector<double> focal_lengths_mm, f_numbers;
};

LensValues values_for(const Impulse& impulse, const SweepAxes& axes) {
    if (impulse.kind != ImpulseKind::lens) return {axes.focal_lengths_mm, axes.f_numbers};
    const Prescription prescription = read_prescription(impulse.file);
    const FirstOrder first = first_order(prescription, prescription.wavelength_nm);
    return {{first.efl_mm}, axes.f_numbers.empty() ? std::vector<double>{first.f_number} : axes.f_numbers};
}

void check_not_empty(bool empty, const char* option) {
    if (!empty) return;
    fail(ExitCode::wrong_arguments,
         "{}: missing (got nothing; expected a list, as the sample file names no value)", option);
}

/// Builds an image's file name and caption. The caption contains only settings that vary.
struct Words {
    std::string name, caption;
    void add(const std::string& part, const std::string& words, bool varies) {
        name += (name.empty() ? "" : "_") + part;
        if (varies) caption += (caption.empty() ? "" : "  ") + words;
    }
};

}  // namespace

SweepGrid sweep_grid(const SweepAxes& axes) {
    SweepGrid out;
    std::vector<std::optional<TimeSpan>> shutters(axes.shutters.begin(), axes.shutters.end());
    if (shutters.empty()) shutters.emplace_back();
    check_not_empty(axes.impulses.empty(), "--impulse");
    check_not_empty(axes.focus_m.empty(), "--focus");
    std::vector<LensValues> lenses;
    double pictures = 0;
    for (const Impulse& impulse : axes.impulses) {
        const LensValues& v = lenses.emplace_back(values_for(impulse, axes));
        check_not_empty(v.focal_lengths_mm.empty(), "--focal-length");
        check_not_empty(v.f_numbers.empty(), "--f-number");
        pictures += static_cast<double>(shutters.size()) * static_cast<double>(v.focal_lengths_mm.size()) *
                    static_cast<double>(v.f_numbers.size()) * static_cast<double>(axes.focus_m.size());
    }
    if (pictures > static_cast<double>(most_pictures)) {
        fail(ExitCode::wrong_arguments, "too many combinations (got {:.0f} pictures; expected {} at most)",
             pictures, most_pictures);
    }
    const bool many_impulses = axes.impulses.size() > 1;
    const std::vector<std::string> impulse_labels = labels_of(axes.impulses),
                                   shutter_labels = labels_of(axes.shutters),
                                   focus_labels = labels_of(axes.focus_m);
    for (std::size_t i = 0; i < axes.impulses.size(); ++i) {
        const LensValues& v = lenses[i];
        const std::vector<std::string> length_labels = labels_of(v.focal_lengths_mm),
                                       f_labels = labels_of(v.f_numbers);
        for (std::size_t t = 0; t < shutters.size(); ++t) {
            for (std::size_t l = 0; l < v.focal_lengths_mm.size(); ++l) {
                for (std::size_t n = 0; n < v.f_numbers.size(); ++n) {
                    for (std::size_t s = 0; s < axes.focus_m.size(); ++s) {
                        Words words;
                        words.add("f" + f_labels[n], "f/" + f_labels[n], v.f_numbers.size() > 1);
                        words.add("s" + focus_labels[s], focus_labels[s] + " m", axes.focus_m.size() > 1);
                        if (v.focal_lengths_mm.size() > 1)
                            words.add("F" + length_labels[l], length_labels[l] + " mm", true);
                        if (shutters.size() > 1)
                            words.add("t" + shutter_labels[t], shutter_labels[t] + " s", true);
                        if (many_impulses) words.add(impulse_labels[i], impulse_labels[i], true);
                        if (words.caption.empty())
                            words.caption = "f/" + f_labels[n] + "  " + focus_labels[s] + " m";
                        out.pictures.push_back({axes.impulses[i], shutters[t], v.focal_lengths_mm[l],
                                                v.f_numbers[n], axes.focus_m[s], words.name, words.caption});
                    }
                }
            }
        }
    }
    const LensValues& first = lenses.front();
    for (const std::size_t values : {axes.impulses.size(), shutters.size(), first.focal_lengths_mm.size(),
                                     first.f_numbers.size(), axes.focus_m.size()}) {
        if (values > 1) out.row = values;
    }
    return out;
}

std::optional<std::string> numbered_name(const std::string& pattern, std::size_t i) {
    const std::size_t begin = pattern.find('%');
    if (begin == std::string::npos || pattern.find('%', begin + 1) != std::string::npos) return std::nullopt;
    const std::size_t end = pattern.find('d', begin);
    if (end == std::string::npos || end > begin + 3) return std::nullopt;
    const std::string digits = pattern.substr(begin + 1, end - begin - 1);
    if (!digits.empty() && (digits.size() != 2 || digits[0] != '0' || digits[1] < '1' || digits[1] > '9'))
        return std::nullopt;
    const int width = digits.empty() ? 1 : digits[1] - '0';
    return fmt::format("{}{:0{}}{}", pattern.substr(0, begin), i, width, pattern.substr(end + 1));
}

}  // namespace postlens
