// Linked into the program, this makes it take itself to run on an older processor: of every function that
// core/multiversion.h compiles several times, the clone for x86-64-v3 or the plain one is chosen, on whatever
// machine the test runs, and Embree keeps to SSE2 or AVX2. It stands in for the part of GCC's run time
// (libgcc's cpuinfo) that the choice asks.
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <embree3/rtcore.h>

namespace {

constexpr unsigned level = POSTLENS_CPU_LEVEL;  // 1: any x86-64, 3: x86-64-v3
static_assert(level == 1 || level == 3);

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier): GCC's names; its resolvers look for x86-64-v3 in bit 1 of
// word 2.
extern "C" {
__attribute__((visibility("hidden"))) unsigned __cpu_features2[8] = {0, 0, level == 3 ? 2U : 0U};
__attribute__((visibility("hidden"))) unsigned __cpu_model[4] = {};
__attribute__((visibility("hidden"))) int __cpu_indicator_init() {
    return 0;
}
}
// NOLINTEND(bugprone-reserved-identifier)

// In place of Embree's own, which it calls.
extern "C" RTCDevice rtcNewDevice(const char* /*config*/) {
    const auto of_embree = reinterpret_cast<RTCDevice (*)(const char*)>(dlsym(RTLD_NEXT, "rtcNewDevice"));
    return of_embree(level == 1 ? "isa=sse2" : "isa=avx2");
}

namespace {

// Chosen as the clones are, so this says which of them run.
__attribute__((target("default"))) int chosen() {
    return 1;
}
__attribute__((target("arch=x86-64-v3"))) int chosen() {
    return 3;
}
__attribute__((target("arch=x86-64-v4"))) int chosen() {
    return 4;
}

// The test looks whether the above still fits the compiler.
__attribute__((constructor)) void say_what_is_chosen() {
    if (std::getenv("POSTLENS_SAY_CPU_LEVEL") == nullptr) return;
    std::printf("%d\n", chosen());
    std::exit(EXIT_SUCCESS);
}

}  // namespace
