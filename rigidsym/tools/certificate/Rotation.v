(* Rotations in Coq's own reals, for certificates (NAME.v). The first half defines the words of their theorems: turns,
   C, derivatives, and "F turns with the angular velocity w". Read it, or compare this file with the shipped one. *)
From Coq Require Import Reals Lra FunctionalExtensionality.
Open Scope R_scope.

(* Vectors and matrices *)
Record vec := V { v1 : R; v2 : R; v3 : R }.
Record mat := M { row1 : vec; row2 : vec; row3 : vec }.
Definition dot (a b : vec) := v1 a * v1 b + v2 a * v2 b + v3 a * v3 b.
Definition plus (a b : vec) := V (v1 a + v1 b) (v2 a + v2 b) (v3 a + v3 b).
Definition scale k (a : vec) := V (k * v1 a) (k * v2 a) (k * v3 a).
Definition cross (a b : vec) :=
  V (v2 a * v3 b - v3 a * v2 b) (v3 a * v1 b - v1 a * v3 b) (v1 a * v2 b - v2 a * v1 b).
Definition apply (A : mat) (a : vec) := V (dot (row1 A) a) (dot (row2 A) a) (dot (row3 A) a).
Definition transpose (A : mat) := M (V (v1 (row1 A)) (v1 (row2 A)) (v1 (row3 A)))
  (V (v2 (row1 A)) (v2 (row2 A)) (v2 (row3 A))) (V (v3 (row1 A)) (v3 (row2 A)) (v3 (row3 A))).
Definition mul (A B : mat) := let t := transpose B in
  M (apply t (row1 A)) (apply t (row2 A)) (apply t (row3 A)).
Definition add (A B : mat) := M (plus (row1 A) (row1 B)) (plus (row2 A) (row2 B)) (plus (row3 A) (row3 B)).
Definition times k (A : mat) := M (scale k (row1 A)) (scale k (row2 A)) (scale k (row3 A)).
Definition det (A : mat) := dot (row1 A) (cross (row2 A) (row3 A)).
Definition one := M (V 1 0 0) (V 0 1 0) (V 0 0 1).
Definition C (w : vec) := M (V 0 (- v3 w) (v2 w)) (V (v3 w) 0 (- v1 w)) (V (- v2 w) (v1 w) 0).

(* Turns: about the axes, and by Rodrigues' formula from an axis, a cosine and a sine *)
Definition turn_x a := M (V 1 0 0) (V 0 (cos a) (- sin a)) (V 0 (sin a) (cos a)).
Definition turn_y a := M (V (cos a) 0 (sin a)) (V 0 1 0) (V (- sin a) 0 (cos a)).
Definition turn_z a := M (V (cos a) (- sin a) 0) (V (sin a) (cos a) 0) (V 0 0 1).
Definition turn (v : vec) (c s : R) := add one (add (times s (C v)) (times (1 - c) (mul (C v) (C v)))).
Definition is_rotation A := mul A (transpose A) = one /\ mul (transpose A) A = one /\ det A = 1.

(* Derivatives by time, entry by entry *)
Definition vector_rate (f : R -> vec) t (d : vec) := derivable_pt_lim (fun s => v1 (f s)) t (v1 d) /\
  derivable_pt_lim (fun s => v2 (f s)) t (v2 d) /\ derivable_pt_lim (fun s => v3 (f s)) t (v3 d).
Definition rate (F : R -> mat) t (D : mat) := vector_rate (fun s => row1 (F s)) t (row1 D) /\
  vector_rate (fun s => row2 (F s)) t (row2 D) /\ vector_rate (fun s => row3 (F s)) t (row3 D).

(* F is a rotation that turns at t with the angular velocity w, in components of space or body *)
Definition turns (F : R -> mat) t (w : vec) :=
  is_rotation (F t) /\ exists D, rate F t D /\ mul D (transpose (F t)) = C w.
Definition turns_in_body (F : R -> mat) t (w : vec) :=
  is_rotation (F t) /\ exists D, rate F t D /\ mul (transpose (F t)) D = C w.

(* ---- Lemmas: from here on Coq checks what nobody has to read ---- *)
Ltac expand := cbv [mul add plus apply transpose dot cross det one scale times C turn Rsqr
  row1 row2 row3 v1 v2 v3 turn_x turn_y turn_z].
Ltac entries :=
  repeat match goal with v : vec |- _ => destruct v | A : mat |- _ => destruct A end; expand;
  repeat match goal with |- M _ _ _ = M _ _ _ => f_equal | |- V _ _ _ = V _ _ _ => f_equal end.
Lemma associative A B D : mul (mul A B) D = mul A (mul B D). Proof. entries; ring. Qed.
Lemma transposed A B : transpose (mul A B) = mul (transpose B) (transpose A). Proof. entries; ring. Qed.
Lemma one_right A : mul A one = A. Proof. entries; ring. Qed.
Lemma sum_left A B D : mul (add A B) D = add (mul A D) (mul B D). Proof. entries; ring. Qed.
Lemma det_mul A B : det (mul A B) = det A * det B. Proof. entries; ring. Qed.
Lemma C_turned A w : det A = 1 -> mul (transpose A) A = one -> mul (mul A (C w)) (transpose A) = C (apply A w).
Proof. destruct A as [x y z]; intros d a; set (cofactors := M (cross y z) (cross z x) (cross x y)).
  assert (e : cofactors = M x y z); [ | rewrite <- e at 3; unfold cofactors; entries; ring ].
  transitivity (mul cofactors (mul (transpose (M x y z)) (M x y z))); [ rewrite a, one_right; reflexivity | ].
  transitivity (times (det (M x y z)) (M x y z)); [ unfold cofactors | rewrite d ]; entries; ring.
Qed.
Lemma product_rotation A B : is_rotation A -> is_rotation B -> is_rotation (mul A B).
Proof. intros [a [a' d]] [b [b' e]]; repeat split; [ | | rewrite det_mul, d, e; ring ];
    rewrite transposed, <- associative; [ rewrite (associative A B), b | rewrite (associative _ _ A), a' ];
    rewrite one_right; assumption.
Qed.
Lemma same {A} (P : A -> Prop) a b : P a -> a = b -> P b. Proof. intros; subst; assumption. Qed.
Lemma product_rate F G t A B : rate F t A -> rate G t B ->
  rate (fun s => mul (F s) (G s)) t (add (mul A (G t)) (mul (F t) B)).
Proof. intros [[? [? ?]] [[? [? ?]] [? [? ?]]]] [[? [? ?]] [[? [? ?]] [? [? ?]]]].
  repeat split; (eapply (same (derivable_pt_lim _ _)); [ repeat apply derivable_pt_lim_plus;
    apply derivable_pt_lim_mult; eassumption | simpl; unfold dot; simpl; ring ]).
Qed.
Theorem product F G t v w : turns F t v -> turns G t w ->
  turns (fun s => mul (F s) (G s)) t (plus v (apply (F t) w)).
Proof. intros [f [A [a a']]] [g [B [b b']]]. split; [ apply product_rotation; assumption | ].
  exists (add (mul A (G t)) (mul (F t) B)); split; [ apply product_rate; assumption | ].
  rewrite sum_left, transposed, <- !associative, (associative A (G t)), (proj1 g), one_right, a',
    (associative (F t) B), b', C_turned; [ entries; ring | apply f | apply f ].
Qed.
Theorem rate_of_turns F t w : turns F t w -> rate F t (mul (C w) (F t)).
Proof. intros [f [D [d e]]]. rewrite <- e, associative, (proj1 (proj2 f)), one_right. exact d. Qed.
Lemma transpose_rate F t D : rate F t D -> rate (fun s => transpose (F s)) t (transpose D).
Proof. unfold rate, vector_rate; simpl; tauto. Qed.
Theorem in_body F t w : turns F t (apply (F t) w) -> turns_in_body F t w.
Proof. intro T; pose proof (rate_of_turns _ _ _ T) as d; destruct T as [r _]; split; [ exact r | ].
  destruct r as [_ [a e]]; eexists; split; [ exact d | ].
  rewrite <- C_turned, !associative, a, one_right, <- associative, a by assumption. entries; ring.
Qed.
Lemma squares a : cos a * cos a = 1 - sin a * sin a.
Proof. generalize (sin2_cos2 a); unfold Rsqr; intro H; rewrite <- H; ring. Qed.
Lemma cos_rate f t a : derivable_pt_lim f t a -> derivable_pt_lim (fun s => cos (f s)) t (- sin (f t) * a).
Proof. intro H; exact (derivable_pt_lim_comp f cos t a _ H (derivable_pt_lim_cos (f t))). Qed.
Lemma sin_rate f t a : derivable_pt_lim f t a -> derivable_pt_lim (fun s => sin (f s)) t (cos (f t) * a).
Proof. intro H; exact (derivable_pt_lim_comp f sin t a _ H (derivable_pt_lim_sin (f t))). Qed.
Lemma constant_rate f t a c : (forall s, f s = c) -> derivable_pt_lim f t a -> a = 0.
Proof. intros H d. apply (uniqueness_limite f t _ _ d). intros e p. exists (mkposreal 1 Rlt_0_1). intros h _ _.
  rewrite !H. replace ((c - c) / h - 0) with 0 by (unfold Rdiv; ring). rewrite Rabs_R0. exact p.
Qed.
(* sines and cosines of sums and of whole multiples, by those of their parts and of halves *)
Ltac sums := repeat first [ rewrite sin_plus | rewrite cos_plus | rewrite sin_minus | rewrite cos_minus
  | rewrite sin_neg | rewrite cos_neg | rewrite Rmult_1_l | match goal with
  | |- context [?f (IZR ?n * ?a)] => match f with sin => idtac | cos => idtac end; match n with
    | Z.pos _ => let m := eval compute in (Z.pred n) in replace (IZR n * a) with (a + IZR m * a) by ring
    | Z.neg ?m => replace (IZR n * a) with (- (IZR (Z.pos m) * a)) by ring end
  | |- context [_ (?a * / 2)] => match goal with |- context [?f a] =>
    match f with sin => idtac | cos => idtac end; replace (f a) with (f (2 * (a * / 2))) by (f_equal; field) end end ].
Ltac apart := repeat split; repeat apply Rmult_integral_contrapositive_currified;
  first [ assumption | lra | match goal with H : _ <> 0 |- _ => intro; apply H; lra end ].
Ltac derivative := match goal with
  | H : derivable_pt_lim ?f ?t _ |- derivable_pt_lim (fun s => ?f s) ?t _ => exact H
  | H : forall s, derivable_pt_lim ?f s _ |- derivable_pt_lim (fun s => ?f s) ?t _ => exact (H t)
  | |- derivable_pt_lim (fun _ => ?c) _ _ => apply (derivable_pt_lim_const c)
  | |- derivable_pt_lim (fun s => s) _ _ => apply derivable_pt_lim_id
  | |- derivable_pt_lim (fun s => - @?f s) _ _ => apply (derivable_pt_lim_opp f); derivative
  | |- derivable_pt_lim (fun s => @?f s + @?g s) _ _ => apply (derivable_pt_lim_plus f g); derivative
  | |- derivable_pt_lim (fun s => @?f s - @?g s) _ _ => apply (derivable_pt_lim_minus f g); derivative
  | |- derivable_pt_lim (fun s => @?f s * @?g s) _ _ => apply (derivable_pt_lim_mult f g); derivative
  | |- derivable_pt_lim (fun s => @?f s / @?g s) _ _ => apply (derivable_pt_lim_div f g); [ derivative .. | apart ]
  | |- derivable_pt_lim (fun s => cos (@?f s)) _ _ => apply (cos_rate f); derivative
  | |- derivable_pt_lim (fun s => sin (@?f s)) _ _ => apply (sin_rate f); derivative
  end.
Ltac turning e := split; [ repeat split; entries; e | eexists (M (V _ _ _) (V _ _ _) (V _ _ _)); split;
  [ repeat split; expand; derivative | entries; e ] ].
Theorem turn_x_turns f t a : derivable_pt_lim f t a -> turns (fun s => turn_x (f s)) t (V a 0 0).
Proof. intro; assert (e := squares (f t)); turning ltac:(ring [e]). Qed.
Theorem turn_y_turns f t a : derivable_pt_lim f t a -> turns (fun s => turn_y (f s)) t (V 0 a 0).
Proof. intro; assert (e := squares (f t)); turning ltac:(ring [e]). Qed.
Theorem turn_z_turns f t a : derivable_pt_lim f t a -> turns (fun s => turn_z (f s)) t (V 0 0 a).
Proof. intro; assert (e := squares (f t)); turning ltac:(ring [e]). Qed.
Theorem turn_turns v c s t a : dot v v = 1 -> c t * c t + s t * s t = 1 ->
  derivable_pt_lim c t (- s t * a) -> derivable_pt_lim s t (c t * a) ->
  turns (fun u => turn v (c u) (s u)) t (scale a v).
Proof. destruct v as [x y z]; cbv [dot v1 v2 v3]; intros. assert (m : z * z = 1 - x * x - y * y) by lra.
  assert (k : c t * c t = 1 - s t * s t) by lra. turning ltac:(ring [k m]).
Qed.
Lemma turn_rotation v c s : s * s = (1 - c) * (2 - (1 - c) * dot v v) -> is_rotation (turn v c s).
Proof. destruct v; cbv [dot v1 v2 v3]; intro m; set (d := 1 - c) in m.
  repeat split; cbv [turn]; fold d; entries; ring [m]. Qed.
Theorem quaternion_turns w x y z u c s t a b d e k : (* of the length 1 / sqrt u *)
  (forall r, u r * (w r * w r + x r * x r + y r * y r + z r * z r) = 1) ->
  (forall r, c r = 1 - 2 * u r) -> (forall r, s r = 2 * w r * u r) -> derivable_pt_lim w t a ->
  derivable_pt_lim x t b -> derivable_pt_lim y t d -> derivable_pt_lim z t e -> derivable_pt_lim u t k ->
  k = - (2 * u t * u t * (w t * a + x t * b + y t * d + z t * e)) ->
  turns (fun r => turn (V (x r) (y r) (z r)) (c r) (s r)) t (scale (2 * u t)
    (plus (scale (w t) (V b d e)) (plus (scale (- a) (V (x t) (y t) (z t))) (cross (V (x t) (y t) (z t)) (V b d e))))).
Proof. intros n C S ? ? ? ? ? K; rewrite (functional_extensionality c _ C), (functional_extensionality s _ S).
  assert (m : u t * w t * w t = 1 - u t * x t * x t - u t * y t * y t - u t * z t * z t) by (rewrite <- (n t); ring).
  split; [ apply turn_rotation; cbv [dot v1 v2 v3]; ring [m] | eexists (M (V _ _ _) (V _ _ _) (V _ _ _)); split ];
    [ repeat split; expand; derivative | entries; rewrite K; ring [m] ].
Qed.
