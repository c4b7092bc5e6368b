// For programs that load OpenImageIO when they first need it.
#include <dlfcn.h>
#include <filesystem>

#include "core/error.h"
#include "records/picture_module.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

// From the program's folder, the same in the build folder and where it is installed, so that either may be
// moved.
fs::path module_path() {
    std::error_code ec;
    const fs::path program = fs::read_symlink("/proc/self/exe", ec);
    return (program.parent_path() / POSTLENS_MODULE_FOLDER / "postlens_pictures.so").lexically_normal();
}

const PictureLibrary& load() {
    const std::string path = module_path().string();
    const auto why_not = [&path] {
        const char* reason = ::dlerror();
        fail(ExitCode::invalid_input, "{}: cannot be loaded ({}); what is neither OpenEXR nor PNG needs it",
             path, reason == nullptr ? "no reason given" : reason);
    };
    // Never closed: what it hands out lives as long as the process.
    void* module = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) why_not();
    void* symbol = ::dlsym(module, picture_module_symbol);
    if (symbol == nullptr) why_not();
    return *reinterpret_cast<decltype(&postlens_picture_library_1)>(symbol)();
}

}  // namespace

const PictureLibrary& picture_library() {
    static const PictureLibrary& library = load();
    return library;
}

}  // namespace postlens
