// Many pictures of one sample file: what they have in common is read and prepared once.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "focus/focus.h"
#include "focus/frame.h"
#include "lens/shutter_curve.h"
#include "motionblur/paths_file.h"
#include "planner/auto_picture.h"
#include "sweep/grid.h"
#include "tracer/scene.h"

namespace postlens {

/// How every picture of a sweep is made. Names and defaults are those of `focus`; with a shutter those of
/// `shoot`.
struct PictureSettings {
    /// Absent: the usual one for the file, with a shutter lightfield. With a shutter lightfield, hybrid and
    /// automatic only.
    std::optional<FocusMethod> method;
    Framing framing = Framing::keep;
    DepthSpacing spacing = DepthSpacing::inverse;
    DepthModel depth_model = DepthModel::ray_differentials;
    std::optional<int> depths;
    std::optional<int> views;  ///< absent: 64, with a shutter 128
    ShutterCurve curve = ShutterCurve::box();
    std::vector<ObjectPath> paths;  ///< in place of the file's motion
    const Scene* scene = nullptr;   ///< for hybrid and automatic
    /// Of `automatic`; without it and a scene that is the usual method.
    std::optional<double> target_db;
    bool predict = false;  ///< of each picture how far it is expected to be from the truth
};

struct MadePicture {
    Image image;
    std::string method;  ///< what was used: "pinhole" for f/inf, "motionblur" for f/inf with a shutter
    int depths = 0, views = 0;
    std::optional<FocusGeometry> geometry;  ///< of the image; absent for an orthographic file
    std::vector<FocusWarning> warnings;
    std::optional<double> predicted_db{};  ///< by `automatic`, or asked for
};

/// Makes one picture after the other; each has the bits that focus_picture, hybrid_picture, auto_picture or,
/// for f/inf with a shutter, motion_blur gives for the same settings.
class PictureMaker {
  public:
    /// Keeps a reference to `file`. Throws Error(wrong_arguments) for a method that a shutter does not go
    /// with and Error(invalid_input) for paths of ids that the file does not have.
    PictureMaker(const SampleFileReader& file, PictureSettings settings, bool with_shutter);
    PictureMaker(const PictureMaker&) = delete;
    PictureMaker& operator=(const PictureMaker&) = delete;
    PictureMaker(PictureMaker&&) = delete;
    PictureMaker& operator=(PictureMaker&&) = delete;
    ~PictureMaker() = default;

    [[nodiscard]] MadePicture make(const SweepSetting& setting);

    [[nodiscard]] const PictureSettings& settings() const { return settings_; }
    [[nodiscard]] FocusMethod method() const { return method_; }
    /// For whoever looks at the same records.
    [[nodiscard]] FocusFrame& frame() { return frame_; }

  private:
    [[nodiscard]] MadePicture planned(HybridSettings settings);
    [[nodiscard]] MadePicture by_hybrid(HybridSettings settings);
    [[nodiscard]] MadePicture moving(const SweepSetting& setting, const FocusSettings& focus);
    /// Adds what is expected of it, if that is asked for.
    void predict(MadePicture& picture, const HybridSettings& settings);

    const SampleFileReader& file_;
    PictureSettings settings_;
    FocusMethod method_;
    FocusFrame frame_;
    std::optional<FrameMotion> motion_;
};

/// As `--method` has it.
[[nodiscard]] const char* method_name(FocusMethod method);

}  // namespace postlens
