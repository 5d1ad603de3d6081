// The library's instance of the function bodies in <pliant/simulate/predicted_conflict-inl.h>.
#include <pliant/simulate/predicted_conflict-inl.h>
