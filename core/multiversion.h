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
// In front of several definitions of one function in an anonymous namespace, each for one instruction set:
// "default", "arch=x86-64-v3", "arch=x86-64-v4". Code below all definitions calls the one that suits the
// processor. Other code would call the default one. Not defined where POSTLENS_MULTIVERSION is empty.
#define POSTLENS_VERSION(instruction_set) __attribute__((target(instruction_set)))
#else
#define POSTLENS_MULTIVERSION
#endif
