// Makes many images of one sample file, which is read only once.
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

/// Settings that all images of a sweep share. Their names and defaults are those of the command `focus`, or
/// of `shoot` for images with motion blur.
struct PictureSettings {
    /// Method that makes the images of the sweep. If absent, it is
    /// - lightfield with motion blur (a shutter)
    /// - otherwise automatic if `target_db` or `scene` is given
    /// - otherwise the method that usual_method returns: layers if the file contains hidden surfaces, mirrors
    ///   or glass, else scatter
    ///
    /// With motion blur, only lightfield, hybrid and automatic are allowed.
    std::optional<FocusMethod> method;
    Framing framing = Framing::keep;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    std::optional<int> depths;
    std::optional<int> views;  ///< absent: 64 without a shutter, 128 with one
    ShutterCurve curve = ShutterCurve::box();
    std::vector<ObjectPath> paths;  ///< motion of objects; replaces the motion in the file
    const Scene* scene = nullptr;   ///< scene in which hybrid and automatic trace rays
    /// Accuracy that the method `automatic` must reach, as a PSNR in dB. May be absent. If the scene and the
    /// shutter are absent too, no accuracy can be aimed at, and `automatic` uses the method that usual_method
    /// returns for the file: layers or scatter.
    std::optional<double> target_db;
    bool predict = false;  ///< predict the error of every image (predict_error)
};

/// Default number of views for an image with a shutter.
inline constexpr int default_shutter_views = 128;

/// Throws Error(wrong_arguments) if `depths` or `views` is given but not used by `method`. `method` must not
/// be `automatic`.
void check_counts(const std::optional<int>& depths, const std::optional<int>& views, FocusMethod method);
/// Throws Error(wrong_arguments) if --depth-spacing or --depth-model (depth through mirrors and glass) is
/// given, but has no effect on `method`.
void check_depth_options(DepthSpacing spacing, DepthModel model, FocusMethod method);
/// Throws Error(wrong_arguments) if `method` does not trace rays. Only hybrid and automatic do. `name` is the
/// option that needs rays, and the message begins with it. PictureMaker does not call this function for
/// images with a shutter.
void check_traces_rays(std::string_view name, FocusMethod method);

struct MadePicture {
    Image image;
    std::string method;  ///< method used: "pinhole" for f/inf, "motionblur" for f/inf with a shutter
    int depths = 0, views = 0;
    std::optional<FocusGeometry> geometry;  ///< absent for an orthographic file
    std::vector<FocusWarning> warnings;
    std::optional<double> predicted_db{};  ///< stated or predicted PSNR, dB; absent if unknown
};

/// Makes the images of a sweep, one at a time. Each image is bit-identical to the result of focus_picture,
/// hybrid_picture or auto_picture, depending on the method. If the lens is a pinhole and the image has a
/// shutter, it is the result of motion_blur.
class PictureMaker {
  public:
    /// Prepares to make images from the sample file `file`, to which it keeps a reference. `with_shutter`
    /// tells whether the images have motion blur. Throws Error(wrong_arguments) if a setting or motion blur
    /// does not fit the method. Throws Error(invalid_input) if settings.paths, the motion of objects, names
    /// an unknown object.
    PictureMaker(const SampleFileReader& file, PictureSettings settings, bool with_shutter);
    PictureMaker(const PictureMaker&) = delete;
    PictureMaker& operator=(const PictureMaker&) = delete;
    PictureMaker(PictureMaker&&) = delete;
    PictureMaker& operator=(PictureMaker&&) = delete;
    ~PictureMaker() = default;

    [[nodiscard]] MadePicture make(const SweepSetting& setting);

    [[nodiscard]] const PictureSettings& settings() const { return settings_; }
    [[nodiscard]] FocusMethod method() const { return method_; }
    /// Returns the opened sample file with its prepared records, so that callers need not read it again.
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

/// Returns a method's name as `--method` spells it.
[[nodiscard]] const char* method_name(FocusMethod method);

/// Throws Error(wrong_arguments) for a target PSNR without `automatic`.
void check_target(const std::optional<double>& target_db, FocusMethod method);

}  // namespace postlens
