#include "apps/view/view_export.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <openssl/evp.h>

#include "apps/cli.h"
#include "apps/view/view_page.h"
#include "apps/view/viewed_frame.h"
#include "core/counted.h"
#include "core/files/output_file.h"
#include "core/files/scratch_file.h"
#include "core/files/text_file.h"
#include "core/json_dump.h"
#include "core/progress.h"
#include "pictures/encoded_picture.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

std::string data_uri(const std::string& type, const std::string& bytes) {
    std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
    const int length = ::EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                         reinterpret_cast<const unsigned char*>(bytes.data()),
                                         static_cast<int>(bytes.size()));
    text.resize(static_cast<std::size_t>(length));
    return "data:" + type + ";base64," + text;
}

/// Downscales an image by the integer factor `by`. Each new pixel is the mean of by x by pixels.
Image shrunk(const Image& from, int by) {
    if (by == 1) return from;
    Image out(from.width / by, from.height / by);
    out.exposure_stops = from.exposure_stops;
    for (int y = 0; y < out.height; ++y) {
        for (int x = 0; x < out.width; ++x) {
            for (int k = 0; k < by * by; ++k) {
                const float* p = from.pixel(by * x + k % by, by * y + k / by);
                for (std::size_t c = 0; c < 3; ++c) out.pixel(x, y)[c] += p[c] / static_cast<float>(by * by);
            }
        }
    }
    return out;
}

/// Returns focus distances in metres, from near to far, possibly infinite. They are quantiles of the depths
/// of all pixels, so that many pixels are in focus.
std::vector<double> focus_distances(std::vector<float> inverse, int count) {
    std::sort(inverse.begin(), inverse.end(), std::greater<>());
    std::vector<double> out;
    for (int i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>((i + 0.5) / count * static_cast<double>(inverse.size()));
        const auto v = static_cast<double>(inverse[at]);
        const double focus = v > 1e-4 ? std::stod(fmt::format("{:.3g}", 1 / v)) : HUGE_VAL;
        if (out.empty() || focus > out.back()) out.push_back(focus);
    }
    return out;
}

/// Returns a grey image of the inverse depths, so that the web page can find the depth of a pixel on which
/// the user clicks. Black stands for infinity (inverse depth 0), and white for the inverse depth `greatest`,
/// in 1/m.
EncodedPicture depth_map(const std::vector<float>& inverse, int width, int height, float greatest) {
    // The image is a quarter as wide and high as the frame, which makes the page smaller.
    constexpr int by = 4;
    EncodedPicture out(std::max(1, width / by), std::max(1, height / by));
    for (int y = 0; y < out.height; ++y) {
        for (int x = 0; x < out.width; ++x) {
            const int from_x = std::min(width - 1, by * x + by / 2),
                      from_y = std::min(height - 1, by * y + by / 2);
            const float v = inverse[static_cast<std::size_t>(from_y) * static_cast<std::size_t>(width) +
                                    static_cast<std::size_t>(from_x)];
            const auto level = static_cast<std::uint8_t>(std::lround(255 * std::min(1.0F, v / greatest)));
            for (std::size_t c = 0; c < 3; ++c) {
                out.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) +
                             static_cast<std::size_t>(x)) +
                        c] = level;
            }
        }
    }
    return out;
}

/// The number of images on the exported web page, and the factor by which they are scaled down.
struct Plan {
    int focus_distances = 9, f_numbers = 3, shrunk_by = 1;
    [[nodiscard]] int pictures() const { return focus_distances * f_numbers; }
    /// The next smaller plan.
    [[nodiscard]] Plan less() const {
        if (focus_distances > 5) return {5, f_numbers, shrunk_by};
        if (f_numbers > 1) return {focus_distances, f_numbers - 1, shrunk_by};
        return {9, 2, 2 * shrunk_by};
    }
};

class Exporter {
  public:
    explicit Exporter(const ViewExportOptions& options)
        : options_(options), frame_(open_viewed_frame(options.input)) {
        const Json facts = frame_->facts();
        width_ = facts["width"].get<int>();
        height_ = facts["height"].get<int>();
        if (!facts["f_number"].is_null()) f_number_ = facts["f_number"].get<double>();
    }

    CommandResult run() {
        std::vector<float> inverse = frame_->depths().inverse_per_m;
        // A mirror or glass can produce images behind infinity: their inverse focus distance is negative. No
        // lens can focus on them, so infinity (0) is used.
        for (float& v : inverse) v = std::max(v, 0.0F);
        const float greatest = std::max(1e-3F, *std::max_element(inverse.begin(), inverse.end()));
        // The total size of all images, in bytes, is estimated from one image at the middle focus distance.
        Plan plan;
        const std::vector<double> all = focus_distances(inverse, plan.focus_distances);
        const double one_bytes =
            static_cast<double>(picture(2 * f_number_, all[all.size() / 2], 1).size()) * 4 / 3;
        const auto expected = [&](const Plan& p) {
            return p.pictures() * one_bytes / (p.shrunk_by * p.shrunk_by);
        };
        const double most_bytes = options_.most_mb * 1e6,
                     room = 0.9 * most_bytes - 2e4;  // without the page's own text
        while (expected(plan) > room) {
            plan = plan.less();
            if (width_ / plan.shrunk_by < 64)
                fail(ExitCode::wrong_arguments, "--export-mb: too little for any picture (got {:g})",
                     options_.most_mb);
        }
        for (;;) {
            const std::string page = page_of(plan, inverse, greatest);
            if (static_cast<double>(page.size()) <= most_bytes) return written(page, plan);
            plan = plan.less();
        }
    }

  private:
    /// Returns the image for a lens with the given f-number and focus distance, as the bytes of a JPEG file.
    /// The image is downscaled: it has 1/by of the frame's width and height.
    [[nodiscard]] std::string picture(double f_number, double focus_m, int by) {
        std::vector<std::string> words{"focus", options_.input, fmt::format("--f-number={}", f_number),
                                       fmt::format("--focus={}", focus_m)};
        const std::shared_ptr<KeptFrame> kept = frame_->kept();
        if (kept) words.insert(words.end(), {"--method=lightfield", "--views=64"});
        const CommandResult result = parse_command_line(words, {.pictures_stay = true, .kept = kept}).run();
        method_ = result.json["method"].get<std::string>();
        const ScratchFile file("picture.jpg");
        write_image(file.path(), shrunk(result.pictures.front(), by));
        constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 30U;
        return read_text_file(file.path(), most_bytes);
    }

    [[nodiscard]] std::string page_of(const Plan& plan, const std::vector<float>& inverse, float greatest) {
        const std::vector<double> focus = focus_distances(inverse, plan.focus_distances);
        Json data{{"name", std::filesystem::path(options_.input).filename().string()},
                  {"width", width_},
                  {"height", height_},
                  {"f_numbers", Json::array()},
                  {"focus_m", Json::array()},
                  {"first_focus", focus.size() / 2},
                  {"greatest_inverse", greatest},
                  {"about", about(plan)}};
        for (const double f : focus) data["focus_m"].push_back(json_number(f));
        data["pictures"] = Json::array();
        Progress progress("pictures", static_cast<std::uint64_t>(plan.f_numbers) * focus.size());
        for (int n = 0; n < plan.f_numbers; ++n) {
            const double number = f_number_ * (1 << n);
            data["f_numbers"].push_back(number);
            Json row = Json::array();
            for (const double f : focus) {
                row.push_back(data_uri("image/jpeg", picture(number, f, plan.shrunk_by)));
                progress.advance();
            }
            data["pictures"].push_back(std::move(row));
        }
        data["depths"] =
            data_uri("image/png", png_file(depth_map(inverse, width_, height_, greatest), "depths"));
        std::string json = json_dump(data);
        // Escapes '<', because an object name in the JSON could contain "</script>" and so end the script
        // element.
        for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
            json.replace(at, 1, "\\u003c");
        std::string page(page_file("export.html")->text);
        const std::string place = "/*DATA*/null";
        return page.replace(page.find(place), place.size(), json);
    }

    [[nodiscard]] std::string about(const Plan& plan) const {
        std::string text = fmt::format("Click on what is to be in focus. Made by postlens, method {}{}.",
                                       method_, frame_->kept() ? ", 64 points of the lens a picture" : "");
        const Plan whole;
        if (plan.pictures() < whole.pictures() || plan.shrunk_by > 1) {
            text +=
                fmt::format(" Of {} pictures of {}x{} px it holds {} of {}x{} px.", whole.pictures(), width_,
                            height_, plan.pictures(), width_ / plan.shrunk_by, height_ / plan.shrunk_by);
        }
        return text;
    }

    [[nodiscard]] CommandResult written(const std::string& page, const Plan& plan) const {
        write_file(options_.output, page);
        CommandResult out;
        out.json = {{"pictures", plan.pictures()},
                    {"width", width_ / plan.shrunk_by},
                    {"height", height_ / plan.shrunk_by},
                    {"bytes", page.size()}};
        out.text = fmt::format("{}: {}. {}", options_.output, megabytes(static_cast<double>(page.size())),
                               about(plan));
        return out;
    }

    const ViewExportOptions& options_;
    std::unique_ptr<ViewedFrame> frame_;
    int width_ = 0, height_ = 0;
    double f_number_ = 2.8;  ///< of the widest aperture: the file's, if it states one
    std::string method_;     ///< method that made the last image
};

}  // namespace

CommandResult export_view(const ViewExportOptions& options) {
    if (std::filesystem::path(options.output).extension() != ".html")
        fail(ExitCode::wrong_arguments, "--export: no page (got {}; expected a name that ends with .html)",
             options.output);
    return Exporter(options).run();
}

}  // namespace postlens
