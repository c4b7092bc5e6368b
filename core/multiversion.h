// POSTLENS_MULTIVERSION before a function compiles it for several instruction sets; the best one for the CPU
// is chosen at load time. With -ffp-contract=off all versions give the same bits, as no sum is reordered. GCC
// 12 nevertheless fuses alternating sums and differences of products (as of complex numbers); write these as
// two loops. scripts/check_instruction_sets.sh tests this. On processors other than x86-64, and with clang,
// the macro is empty.
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(POSTLENS_NO_MULTIVERSION)
#define POSTLENS_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define POSTLENS_MULTIVERSION
#endif
