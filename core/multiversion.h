// The macro POSTLENS_MULTIVERSION, in front of a function, compiles the function for several instruction
// sets. With -ffp-contract=off, all versions give bit-identical results. With clang, and on processors other
// than x86-64, the macro is empty.
//
// In spite of -ffp-contract=off, GCC 12 fuses multiplications with additions if a loop alternates between
// sums and differences of products, as complex arithmetic does. Split such a loop into two loops.
// scripts/check_instruction_sets.sh reports fused instructions.
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(POSTLENS_NO_MULTIVERSION)
#define POSTLENS_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
// Marks a function that is written three times in an anonymous namespace, once for each instruction set:
// "default", "arch=x86-64-v3" and "arch=x86-64-v4". A call of this function uses the processor's version, but
// only if the call stands below all three. A call above them would use the default version.
#define POSTLENS_FOR_INSTRUCTION_SET(instruction_set) __attribute__((target(instruction_set)))
#else
#define POSTLENS_MULTIVERSION
#endif
