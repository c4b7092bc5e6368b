// Makes many images of one sample file, whose records are read and prepared only once.
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

/// Settings that are common to all images of a sweep. Their names and defaults are those of the command
/// `focus`, or of the command `shoot` if there is a shutter.
struct PictureSettings {
    /// The method. If absent, images with a shutter use lightfield, and other images use the default method
    /// for the file (usual_method). With a shutter, only lightfield, hybrid and automatic are allowed.
    std::optional<FocusMethod> method;
    Framing framing = Framing::keep;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    std::optional<int> depths;
    std::optional<int> views;  ///< absent: 64 without a shutter, 128 with one
    ShutterCurve curve = ShutterCurve::box();
    std::vector<ObjectPath> paths;  ///< motion of objects; replaces the motion in the file
    const Scene* scene = nullptr;   ///< scene in which hybrid and automatic trace rays
    /// The PSNR, in dB, that the method `automatic` must reach. If target, scene and shutter are all absent,
    /// `automatic` uses the default method for the file.
    std::optional<double> target_db;
    bool predict = false;  ///< predict the error of every image (predict_error)
};

/// Number of views that are averaged for an image with a shutter, if the settings give no number.
inline constexpr int default_shutter_views = 128;

/// Throws Error(wrong_arguments) if a number of depths or views is given for a method that does not use it.
/// `method` must not be `automatic`; the caller first replaces it by the method that it selects.
void check_counts(const std::optional<int>& depths, const std::optional<int>& views, FocusMethod method);
/// Throws Error(wrong_arguments) if --depth-spacing or --depth-model is given for a method that does not use
/// it. --depth-model selects how depth is measured through mirrors and glass.
void check_depth_options(DepthSpacing spacing, DepthModel model, FocusMethod method);
/// Throws Error(wrong_arguments) if the option `name` (--scene or --explain) is given, but `method` traces no
/// rays. Only used for images without a shutter.
void check_traces_rays(std::string_view name, FocusMethod method);

struct MadePicture {
    Image image;
    std::string method;  ///< method used: "pinhole" for f/inf, "motionblur" for f/inf with a shutter
    int depths = 0, views = 0;
    std::optional<FocusGeometry> geometry;  ///< absent for an orthographic file
    std::vector<FocusWarning> warnings;
    std::optional<double> predicted_db{};  ///< stated or predicted PSNR, dB; absent if unknown
};

/// Makes images one at a time. Each image is bit-identical to the result of focus_picture, hybrid_picture or
/// auto_picture with the same settings. For a pinhole (f/inf) with a shutter, it is bit-identical to the
/// result of motion_blur.
class PictureMaker {
  public:
    /// Keeps a reference to `file`. Throws Error(wrong_arguments) if there is a shutter and the method does
    /// not support one. Throws Error(invalid_input) if a motion path has an object id that is not in the
    /// file.
    PictureMaker(const SampleFileReader& file, PictureSettings settings, bool with_shutter);
    PictureMaker(const PictureMaker&) = delete;
    PictureMaker& operator=(const PictureMaker&) = delete;
    PictureMaker(PictureMaker&&) = delete;
    PictureMaker& operator=(PictureMaker&&) = delete;
    ~PictureMaker() = default;

    [[nodiscard]] MadePicture make(const SweepSetting& setting);

    [[nodiscard]] const PictureSettings& settings() const { return settings_; }
    [[nodiscard]] FocusMethod method() const { return method_; }
    /// Returns the frame with its prepared records, so that other code can use the same records.
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

/// Returns the name of a method as the option `--method` spells it.
[[nodiscard]] const char* method_name(FocusMethod method);

/// Throws Error(wrong_arguments) if a target PSNR is given for a method other than `automatic`.
void check_target(const std::optional<double>& target_db, FocusMethod method);

}  // namespace postlens
