// The library's instance of the function bodies in <pliant/method/dormand_prince-inl.h>.
#include <pliant/method/dormand_prince-inl.h>
