#include "pictures/stacks/object_choice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "core/memory.h"
#include "core/text.h"
#include "pictures/foreign/cryptomatte.h"
#include "pictures/image.h"

namespace postlens {
namespace {

/// Fractions of a pixel below this are treated as rounding errors.
constexpr float least_share = 1e-4F;

std::vector<float> mask_of(const ForeignPicture& picture, const ObjectChoice& choice) {
    const Image mask = read_image(choice.object, PictureValues::stored);
    if (mask.width != picture.width || mask.height != picture.height) {
        fail(ExitCode::invalid_input,
             "{}: {} has another size than the picture (got {}x{} px; expected {}x{})", choice.option,
             choice.object, mask.width, mask.height, picture.width, picture.height);
    }
    std::vector<float> out(mask.rgb.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float mean = (mask.rgb[3 * i] + mask.rgb[3 * i + 1] + mask.rgb[3 * i + 2]) / 3;
        if (!std::isfinite(mean)) {
            fail(ExitCode::invalid_input, "{}: {} at pixel {},{} is unusable (got {}; expected 0 to 1)",
                 choice.option, choice.object, i % static_cast<std::size_t>(mask.width),
                 i / static_cast<std::size_t>(mask.width), mean);
        }
        out[i] = std::clamp(mean, 0.0F, 1.0F);
    }
    return out;
}

/// Returns the ids that can be meant by `object`, the text by which a user names an object, the most likely
/// first:
/// - the id that the Cryptomatte's manifest (list of names and ids) gives for this name
/// - the hash of the name, which a Cryptomatte uses as the id
/// - if the text is an integer, this integer, and the bits of the float with the same value
std::vector<std::uint32_t> ids_of(const ForeignPicture& picture, const std::string& object) {
    std::vector<std::uint32_t> out;
    if (const auto& matte = picture.channels.matte) {
        for (const ManifestObject& o :
             manifest_objects(matte->manifest).value_or(std::vector<ManifestObject>())) {
            if (o.name == object) out.push_back(o.id);
        }
    }
    out.push_back(cryptomatte_id(object));
    std::uint32_t number = 0;
    const char* end = object.data() + object.size();
    if (const auto [at, error] = std::from_chars(object.data(), end, number);
        error == std::errc() && at == end) {
        out.push_back(number);
        out.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(number)));
    }
    return out;
}

[[noreturn]] void fail_unknown(const ForeignPicture& picture, const ObjectChoice& choice) {
    const ForeignChannels& c = picture.channels;
    std::string expected =
        "an image file: " + (c.problems.empty() ? "the picture has no ids" : c.problems.front());
    if (c.matte) {
        expected = "a name of the Cryptomatte " + c.matte->name;
        const auto names = manifest_names(c.matte->manifest);
        if (names && !names->empty()) expected += ": " + listed(*names);
    } else if (!c.id.empty()) {
        expected = "a number of the channel " + c.id;
    }
    fail(ExitCode::wrong_arguments, "{}: no pixel shows it (got {}; expected {})", choice.option,
         choice.object, expected);
}

/// Divides a sample into two samples at the same depth. The first one belongs to the selected object and gets
/// the fraction `share` of the sample's colour and alpha. The second one gets the rest, so that both together
/// composite to the sample.
std::array<StackSample, 2> divided(const StackSample& s, float share) {
    std::array<StackSample, 2> out{s, s};
    const float rest = (1 - share) / (1 - share * s.alpha);
    for (float* v : {&out[0].r, &out[0].g, &out[0].b, &out[0].alpha}) *v *= share;
    for (float* v : {&out[1].r, &out[1].g, &out[1].b, &out[1].alpha}) *v *= rest;
    // Without this, rounding could make an opaque sample slightly transparent.
    if (s.alpha == 1) out[1].alpha = 1;
    return out;
}

/// Selects an object in a pixel, which is a stack of samples. Samples are chosen until together they cover
/// the fraction of the pixel that the object covers. If a sample would exceed this fraction, it is divided
/// into two samples. One MaskedStack is used for all pixels, to avoid allocations.
class MaskedStack {
  public:
    explicit MaskedStack(std::uint16_t mask) : mask_(mask) {}

    void choose(std::span<const StackSample> stack, float share) {
        samples_.assign(stack.begin(), stack.end());
        chosen_.assign(stack.size(), 0);
        if (stack.empty()) return;
        const auto is_any = [](const StackSample&) { return true; };
        const auto is_same = [this](const StackSample& s) { return s.mask == mask_; };
        // `mask_` is the number of the mask image (a file) by which the user selects an object. If samples of
        // this pixel were chosen for this mask image before, exactly these are chosen again.
        if (std::any_of(samples_.begin(), samples_.end(), is_same)) {
            take(1, is_same);
            return;
        }
        // `share` is the fraction of this pixel that the object covers according to the user's mask image.
        // Samples that no mask image has selected before (`mask` is 0) are chosen first, because different
        // mask images usually select different objects.
        take(take(share, [](const StackSample& s) { return s.mask == 0; }), is_any);
    }
    [[nodiscard]] const std::vector<StackSample>& samples() const { return samples_; }
    [[nodiscard]] const std::vector<std::uint8_t>& chosen() const { return chosen_; }

  private:
    /// Chooses samples from a pixel's stack, for an object that covers the fraction `share` of the pixel.
    /// Goes through the samples at the nearest depth of the stack, and chooses those for which `wanted`
    /// returns true, until they cover `share`. Returns the fraction of the pixel that is still missing.
    template <typename Wanted>
    float take(float share, const Wanted& wanted) {
        float left = 1;
        const float nearest = samples_.front().inverse_z;
        for (std::size_t k = 0; k < samples_.size() && samples_[k].inverse_z == nearest; ++k) {
            const StackSample s = samples_[k];
            const float covers = left * s.alpha;
            left -= covers;
            if (chosen_[k] != 0 || !wanted(s) || share < least_share) continue;
            if (share > covers - least_share) {
                share -= covers;
                chosen_[k] = 1;
                if (s.mask == 0) samples_[k].mask = mask_;
            } else {
                std::array<StackSample, 2> parts = divided(s, share / covers);
                share = 0;
                parts[0].mask = mask_;
                samples_[k] = parts[1];
                samples_.insert(samples_.begin() + static_cast<std::ptrdiff_t>(k), parts[0]);
                chosen_.insert(chosen_.begin() + static_cast<std::ptrdiff_t>(k), 1);
                ++k;
            }
        }
        return share;
    }

    std::vector<StackSample> samples_;
    std::vector<std::uint8_t> chosen_;
    std::uint16_t mask_;
};

std::uint16_t number_of_mask(ForeignPicture& picture, const std::string& file) {
    const auto at = std::find(picture.masks.begin(), picture.masks.end(), file);
    const auto number = static_cast<std::uint16_t>(at - picture.masks.begin() + 1);
    if (at == picture.masks.end()) picture.masks.push_back(file);
    return number;
}

std::vector<std::uint8_t> choose_by_mask(ForeignPicture& picture, const std::vector<float>& mask,
                                         std::uint16_t number) {
    require_memory((picture.samples.size() + mask.size()) * (sizeof(StackSample) + 1),
                   "the samples of an object");
    std::vector<StackSample> samples;
    samples.reserve(picture.samples.size() + mask.size());
    std::vector<std::uint64_t> offsets{0};
    offsets.reserve(picture.offsets.size());
    std::vector<std::uint8_t> chosen;
    MaskedStack masked(number);
    for (int y = picture.y_begin; y < picture.y_end; ++y) {
        for (int x = picture.x_begin; x < picture.x_end; ++x) {
            // An object may continue outside the image, where the mask ends. So the mask's border values are
            // repeated there.
            const auto column = static_cast<std::size_t>(std::clamp(x, 0, picture.width - 1)),
                       row = static_cast<std::size_t>(std::clamp(y, 0, picture.height - 1));
            masked.choose(picture.stack(x, y), mask[row * static_cast<std::size_t>(picture.width) + column]);
            samples.insert(samples.end(), masked.samples().begin(), masked.samples().end());
            chosen.insert(chosen.end(), masked.chosen().begin(), masked.chosen().end());
            offsets.push_back(samples.size());
        }
    }
    picture.samples = std::move(samples);
    picture.offsets = std::move(offsets);
    return chosen;
}

std::vector<std::uint8_t> choose_by_id(const ForeignPicture& picture, const ObjectChoice& choice) {
    std::vector<std::uint8_t> out(picture.samples.size());
    for (const std::uint32_t id : ids_of(picture, choice.object)) {
        bool found = false;
        for (std::size_t i = 0; i < out.size(); ++i) {
            if (picture.samples[i].id != id || id == 0) continue;
            out[i] = 1;
            found = true;
        }
        if (found) return out;
    }
    fail_unknown(picture, choice);
}

}  // namespace

bool ObjectChoice::is_file() const {
    const std::string ending = lower_case(std::filesystem::path(object).extension().string());
    constexpr std::array endings{".exr", ".png", ".tif", ".tiff", ".jpg", ".jpeg"};
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

std::vector<std::uint8_t> choose_samples(ForeignPicture& picture, const ObjectChoice& choice) {
    if (!choice.is_file()) return choose_by_id(picture, choice);
    const std::vector<float> mask = mask_of(picture, choice);
    return choose_by_mask(picture, mask, number_of_mask(picture, choice.object));
}

std::vector<float> choose_pixels(const ForeignPicture& picture, const ObjectChoice& choice) {
    if (choice.is_file()) return mask_of(picture, choice);
    const std::vector<std::uint8_t> chosen = choose_by_id(picture, choice);
    std::vector<float> out(static_cast<std::size_t>(picture.width) *
                           static_cast<std::size_t>(picture.height));
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            if (!picture.stores(x, y)) continue;
            double left = 1, shown = 0;
            const auto stack = picture.stack(x, y);
            const auto first = static_cast<std::size_t>(stack.data() - picture.samples.data());
            for (std::size_t k = 0; k < stack.size(); ++k) {
                const auto alpha = static_cast<double>(stack[k].alpha);
                if (chosen[first + k] != 0) shown += left * alpha;
                left *= 1 - alpha;
            }
            out[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                static_cast<std::size_t>(x)] = static_cast<float>(shown);
        }
    }
    return out;
}

}  // namespace postlens
