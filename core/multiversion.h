// POSTLENS_MULTIVERSION in front of a function compiles the function for several instruction sets. The
// version for the CPU is chosen when the program is loaded. With -ffp-contract=off, all versions give
// bit-identical results, because no sum is reordered.
//
// There is one exception: GCC 12 still fuses alternating sums and differences of products, such as those in
// complex arithmetic. Split such code into two loops. scripts/check_instruction_sets.sh finds functions that
// have this problem.
//
// With clang, and on processors other than x86-64, the macro is empty.
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(POSTLENS_NO_MULTIVERSION)
#define POSTLENS_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define POSTLENS_MULTIVERSION
#endif
