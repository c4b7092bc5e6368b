#include "apps/command.h"

namespace postlens {

CommandResult run_trace(const TraceOptions& options) {
    const Scene scene = read_scene(options.scene, {.metres_per_unit = options.metres_per_unit});
    CommandResult out;
    for (const std::string& note : scene.notes) out.warnings.push_back({"scene", note});
    const TraceResult r = trace_to_file(scene, options.settings, options.output);
    out.json = {{"records", r.records},
                {"bytes", r.bytes},
                {"rays",
                 {{"eye", r.rays.eye},
                  {"eye_hits", r.rays.eye_hits},
                  {"reflect", r.rays.reflect},
                  {"refract", r.rays.refract},
                  {"shadow", r.rays.shadow}}},
                {"overscan_px", r.overscan_px}};
    out.text = fmt::format("{}: {} records, {:.1f} MB; {} eye, {} reflected, {} refracted, {} shadow rays",
                           options.output, r.records, static_cast<double>(r.bytes) / 1e6, r.rays.eye,
                           r.rays.reflect, r.rays.refract, r.rays.shadow);
    return out;
}

}  // namespace postlens
