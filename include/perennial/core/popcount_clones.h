#pragma once

/// Put before a function whose time goes into hammingDistance(): on x86-64 it is compiled twice, with the processor's
/// instruction that counts bits and without, and the faster one that runs is chosen when the program is loaded. Both
/// give the same results. Elsewhere (64-bit Arm counts bits in its vector unit) the compiler needs no help.
#if defined(__x86_64__) && defined(__ELF__) && defined(__GNUC__) && (!defined(__clang__) || __clang_major__ >= 14)
#define PERENNIAL_POPCOUNT_CLONES __attribute__((target_clones("popcnt", "default")))
#else
#define PERENNIAL_POPCOUNT_CLONES
#endif
