// Makes many images of one sample file. The records are read and prepared only once.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/shutter_curve.h"
#include "motionblur/paths/paths_file.h"
#include "planner/auto_picture.h"
#include "scene/scene.h"
#include "sweep/grid.h"

namespace postlens {

/// Settings that are common to all images of a sweep. Names and defaults are those of the command `focus`, or
/// of `shoot` if there is a shutter.
struct PictureSettings {
    /// If absent: the default method for the file (usual_method), or lightfield if there is a shutter. With a
    /// shutter, only lightfield, hybrid and automatic are allowed.
    std::optional<FocusMethod> method;
    Framing framing = Framing::keep;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    std::optional<int> depths;
    std::optional<int> views;  ///< absent: 64 without a shutter, 128 with one
    ShutterCurve curve = ShutterCurve::box();
    std::vector<ObjectPath> paths;  ///< motion of objects, which replaces the file's
    const Scene* scene = nullptr;   ///< scene in which hybrid and automatic trace rays
    /// PSNR, dB, that `automatic` must reach. If this and the scene are absent and there is no shutter,
    /// `automatic` is the default method for the file.
    std::optional<double> target_db;
    bool predict = false;  ///< predict the error of every image (predict_error)
};

/// Views with a shutter, if their number is not given.
inline constexpr int default_shutter_views = 128;

/// Refuses a number of depths or views if the method does not use it. `automatic` must already be replaced by
/// the method that it selects. Throws Error(wrong_arguments).
void check_counts(const std::optional<int>& depths, const std::optional<int>& views, FocusMethod method);
/// Refuses --depth-spacing, and --depth-model (how depth is measured through mirrors and glass), if the
/// method does not use them. Throws Error(wrong_arguments).
void check_depth_options(DepthSpacing spacing, DepthModel model, FocusMethod method);
/// Refuses the option `name` (--scene or --explain) if the method traces no rays. For images without a
/// shutter. Throws Error(wrong_arguments).
void check_traces_rays(std::string_view name, FocusMethod method);

struct MadePicture {
    Image image;
    std::string method;  ///< method used: "pinhole" for f/inf, "motionblur" for f/inf with a shutter
    int depths = 0, views = 0;
    std::optional<FocusGeometry> geometry;  ///< absent for an orthographic file
    std::vector<FocusWarning> warnings;
    std::optional<double> predicted_db{};  ///< stated or predicted PSNR, dB; absent if unknown
};

/// Makes images one at a time. Each is bit-identical to the result of focus_picture, hybrid_picture,
/// auto_picture or, for f/inf with a shutter, motion_blur with the same settings.
class PictureMaker {
  public:
    /// Keeps a reference to `file`. Throws Error(wrong_arguments) for a method that does not support a
    /// shutter, and Error(invalid_input) for a motion path whose id is not in the file.
    PictureMaker(const SampleFileReader& file, PictureSettings settings, bool with_shutter);
    PictureMaker(const PictureMaker&) = delete;
    PictureMaker& operator=(const PictureMaker&) = delete;
    PictureMaker(PictureMaker&&) = delete;
    PictureMaker& operator=(PictureMaker&&) = delete;
    ~PictureMaker() = default;

    [[nodiscard]] MadePicture make(const SweepSetting& setting);

    [[nodiscard]] const PictureSettings& settings() const { return settings_; }
    [[nodiscard]] FocusMethod method() const { return method_; }
    /// The frame with its prepared records, so that other code can use the same records.
    [[nodiscard]] FocusFrame& frame() { return frame_; }

  private:
    [[nodiscard]] MadePicture planned(HybridSettings settings);
    [[nodiscard]] MadePicture by_hybrid(HybridSettings settings);
    [[nodiscard]] MadePicture moving(const SweepSetting& setting, const FocusSettings& focus);
    /// Sets predicted_db if the settings ask for it.
    void predict(MadePicture& picture, const HybridSettings& settings);

    const SampleFileReader& file_;
    PictureSettings settings_;
    FocusMethod method_;
    FocusFrame frame_;
    std::optional<FrameMotion> motion_;
};

/// Name of a method, as in the option `--method`.
[[nodiscard]] const char* method_name(FocusMethod method);

/// Throws Error(wrong_arguments) if a target error is given for a method that has none.
void check_target(const std::optional<double>& target_db, FocusMethod method);

}  // namespace postlens
