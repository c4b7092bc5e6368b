// POSTLENS_MULTIVERSION before a function compiles it for several instruction sets; the CPU's best is chosen
// at load time. With -ffp-contract=off every version gives the same bits, as no sum is reordered.
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(POSTLENS_NO_MULTIVERSION)
#define POSTLENS_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define POSTLENS_MULTIVERSION
#endif
