// Implements picture_library(), which returns the functions to read and write image files with OpenImageIO.
// Here, they are in a module that the program loads when it first needs them.
#include <dlfcn.h>
#include <filesystem>

#include "core/error.h"
#include "core/thread_limits.h"
#include "pictures/formats/picture_module.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

// Returns the path of the program or extension module that contains this code. dladdr may report only the
// name by which a program was started, so /proc/self/exe is used for it.
fs::path own_file() {
    std::error_code ec;
    Dl_info own{};
    if (::dladdr(reinterpret_cast<const void*>(&own_file), &own) != 0 && own.dli_fname != nullptr &&
        fs::path(own.dli_fname).is_absolute()) {
        return fs::canonical(own.dli_fname, ec);
    }
    return fs::read_symlink("/proc/self/exe", ec);
}

// Searches all folders above this code's file for the module postlens_pictures.so, so that the build folder
// and the installation can be moved.
fs::path module_path() {
    const fs::path first = own_file().parent_path().parent_path();
    std::error_code ec;
    for (fs::path folder = first; !folder.empty(); folder = folder.parent_path()) {
        fs::path module = folder / POSTLENS_MODULE_FOLDER / "postlens_pictures.so";
        if (fs::exists(module, ec)) return module;
        if (folder == folder.root_path()) break;
    }
    return first / POSTLENS_MODULE_FOLDER / "postlens_pictures.so";
}

const PictureLibrary& load() {
    const std::string path = module_path().string();
    const auto why_not = [&path] {
        const char* reason = ::dlerror();
        fail(ExitCode::invalid_input, "{}: cannot be loaded ({}); what is neither OpenEXR nor PNG needs it",
             path, reason == nullptr ? "no reason given" : reason);
    };
    require_threads(picture_module_threads);
    // The shared library is never closed, because its objects live until the process ends.
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
