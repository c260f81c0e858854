! Forced, damped Mathieu equation q'' + 0.1 q' + (1.2 + 0.4 cos Omega t) q = cos Omega t for AUTO-07p. The oscillator
! x' = x + Omega y - x (x^2 + y^2), y' = -Omega x + y - y (x^2 + y^2) has the solution x = sin Omega t, y = cos Omega t.
! PAR(1): Omega, PAR(2): 2-norm of q, sqrt(integral of q^2 over one period in units of it), PAR(11): period.
subroutine FUNC(NDIM, U, ICP, PAR, IJAC, F, DFDU, DFDP)
  implicit none
  integer, intent(in) :: NDIM, ICP(*), IJAC
  double precision, intent(in) :: U(NDIM), PAR(*)
  double precision, intent(out) :: F(NDIM)
  double precision, intent(inout) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
  double precision :: x, y, q, p, r
  x = U(1)
  y = U(2)
  q = U(3)
  p = U(4)
  r = 1 - x * x - y * y
  F(1) = r * x + PAR(1) * y
  F(2) = r * y - PAR(1) * x
  F(3) = p
  F(4) = y - 0.1d0 * p - (1.2d0 + 0.4d0 * y) * q
  if (IJAC == 0) return
  DFDU = 0
  DFDU(1, 1) = r - 2 * x * x
  DFDU(1, 2) = PAR(1) - 2 * x * y
  DFDU(2, 1) = -PAR(1) - 2 * x * y
  DFDU(2, 2) = r - 2 * y * y
  DFDU(3, 4) = 1
  DFDU(4, 2) = 1 - 0.4d0 * q
  DFDU(4, 3) = -(1.2d0 + 0.4d0 * y)
  DFDU(4, 4) = -0.1d0
  if (IJAC == 1) return
  DFDP(:, 1) = 0
  DFDP(1, 1) = y
  DFDP(2, 1) = -x
end subroutine

! At rest but for the oscillator: the equation is linear in q, so that Newton's method needs no better one.
subroutine STPNT(NDIM, U, PAR, T)
  implicit none
  integer, intent(in) :: NDIM
  double precision, intent(inout) :: U(NDIM), PAR(*)
  double precision, intent(in) :: T
  double precision, parameter :: turn = 6.283185307179586476925287d0
  PAR(1) = 0.32d0
  PAR(11) = turn / PAR(1)
  U(1) = sin(turn * T)
  U(2) = cos(turn * T)
  U(3) = U(2) / (1.2d0 + 0.4d0 * U(2))
  U(4) = -PAR(1) * U(1) / 1.2d0
end subroutine

subroutine PVLS(NDIM, U, PAR)
  implicit none
  integer, intent(in) :: NDIM
  double precision, intent(in) :: U(NDIM)
  double precision, intent(inout) :: PAR(*)
  double precision, external :: GETP
  PAR(2) = GETP("NRM", 3, U)
end subroutine

subroutine BCND
end subroutine

subroutine ICND
end subroutine

subroutine FOPT
end subroutine
