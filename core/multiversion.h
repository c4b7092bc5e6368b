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
// Stands in front of each of three definitions of one function in an anonymous namespace, one for each
// instruction set: "default", "arch=x86-64-v3", "arch=x86-64-v4". Code below all three calls the one that
// suits the processor; other code would call the default one. The macro is not defined where
// POSTLENS_MULTIVERSION is empty.
#define POSTLENS_FOR_INSTRUCTION_SET(instruction_set) __attribute__((target(instruction_set)))
#else
#define POSTLENS_MULTIVERSION
#endif
