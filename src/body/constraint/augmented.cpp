// The compiled function bodies of augmented-inl.h.
#include <pliant/body/constraint/augmented-inl.h>
