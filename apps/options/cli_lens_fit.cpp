#include <memory>

#include "apps/lens/lens_fit_limits_command.h"
#include "apps/options/cli_options.h"

namespace postlens {

std::shared_ptr<LensFitLimitsOptions> fit_limits_options(CLI::App& app) {
    const auto o = std::make_shared<LensFitLimitsOptions>();
    app.add_option("--pairs", o->pairs,
                   "Find F, n and s from measured circles of confusion: lines distance_m,coc_mm")
        ->type_name("FILE.csv");
    app.add_option_function<std::string>(
           "--sharp", [o](const std::string& text) { o->sharp = parse_depths("--sharp", text); },
           "Find F, n and s that make everything between two depths sharp, m")
        ->type_name("NEAR:FAR|inf");
    number(app, "--coc-limit", o->coc_limit_mm,
           "With --sharp: widest circle of confusion that counts as sharp [default: 1/1500 of the sensor's "
           "diagonal]",
           "MM", above_0);
    app.add_option_function<std::string>(
           "--sensor", [o](const std::string& text) { o->sensor_mm = parse_sensor("--sensor", text); },
           "With --sharp: the sensor, for its diagonal and the angle of view, mm")
        ->type_name("WxH");
    number(app, "--focal-length", o->focal_length_mm, "F, where it is known [default: to be found]", "MM",
           above_0);
    app.add_option("--picture", o->picture,
                   "Which lens took this? Find F/n and s such that focus makes this picture from --frame")
        ->type_name("IMAGE");
    app.add_option("--frame", o->frame, "With --picture: the sample file of the same view")
        ->type_name("FRAME");
    impulse_options(app, o->impulse);
    return o;
}

}  // namespace postlens
