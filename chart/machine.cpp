#include "chart/machine.h"

#include <OpenEXR/OpenEXRConfig.h>
#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <string>
#include <thread>

#include "core/threads.h"

namespace postlens {
namespace {

// Returns the value of the first line of the form "key   : value" in a file such as /proc/cpuinfo, or
// nothing.
std::string first_value(const char* path, const std::string& key) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.rfind(key, 0) != 0) continue;
        const std::size_t colon = line.find(':');
        if (colon == std::string::npos) continue;
        const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
        return begin == std::string::npos ? "" : line.substr(begin);
    }
    return "";
}

}  // namespace

nlohmann::ordered_json machine_json() {
    return {{"processor", first_value("/proc/cpuinfo", "model name")},
            {"cores", std::thread::hardware_concurrency()},
            {"threads", thread_count()},
            {"memory", first_value("/proc/meminfo", "MemTotal")},
            {"compiler", __VERSION__},
            {"postlens", POSTLENS_VERSION},
            {"embree", RTC_VERSION_STRING},
            {"openexr", OPENEXR_VERSION_STRING},
            {"openimageio", POSTLENS_OPENIMAGEIO_VERSION},
            {"opencv", CV_VERSION}};
}

}  // namespace postlens
