// POSTLENS_MULTIVERSION before a function compiles it for several instruction sets; the CPU's best is chosen
// at load time. With -ffp-contract=off every version gives the same bits, as no sum is reordered; GCC 12
// fuses sums and differences of products in turn (complex numbers) all the same, which is to be written as
// two loops. scripts/check_instruction_sets.sh looks. On processors other than x86-64, and with clang, it
// means nothing.
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(POSTLENS_NO_MULTIVERSION)
#define POSTLENS_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define POSTLENS_MULTIVERSION
#endif
